; Emitted by cdlc from the CDL domain "logistics".
(define (domain logistics)
  (:requirements :strips :typing)
  (:types
    city - place
    vehicle - thing
    truck plane - vehicle
    place thing unused - object)
  (:constants depot - place spare - truck paris - city)
  (:predicates
    (at ?t - thing ?p - place)
    (in ?t - thing ?v - vehicle)
    (road ?a ?b - place))
  (:action drive  ; drive_to
    :parameters (?t - truck ?from ?to - place)
    :precondition (and
      (at ?t ?from)
      (road ?from ?to))
    :effect (and
      (not (at ?t ?from))
      (at ?t ?to)))
  (:action fly  ; fly_to
    :parameters (?p - plane ?from ?to - city)
    :precondition (and
      (at ?p ?from))
    :effect (and
      (not (at ?p ?from))
      (at ?p ?to)))
  (:action send_home  ; send_home
    :parameters (?t - truck ?from - place)
    :precondition (and
      (at ?t ?from))
    :effect (and
      (not (at ?t ?from))
      (at ?t depot)))
  (:action load  ; put_in
    :parameters (?t - thing ?v - vehicle ?p - place)
    :precondition (and
      (at ?t ?p)
      (at ?v ?p))
    :effect (and
      (not (at ?t ?p))
      (in ?t ?v))))

; Emitted by cdlc from the CDL problem "deliver".
(define (problem deliver)
  (:domain logistics)
  (:objects
    parcel - thing
    t1 t2 - truck
    p1 - plane
    x y - place
    rome - city)
  (:init
    (at spare x)
    (at parcel x)
    (at t1 depot)
    (at p1 paris)
    (road depot x)
    (road x depot))
  (:goal (and
    (in parcel spare)
    (at p1 rome)
    (at t1 x))))
