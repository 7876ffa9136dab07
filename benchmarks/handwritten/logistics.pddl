(define (domain logistics)
  (:requirements :strips :typing :negative-preconditions :equality)
  (:types
    truck plane - vehicle
    airport - location
    location vehicle - place
    place city package - object)
  (:predicates
    (at ?v - vehicle ?l - location)
    (in ?p - package ?at - place)
    (city_of ?l - location ?c - city))
  (:action drive
    :parameters (?t - truck ?from ?to - location ?c - city)
    :precondition (and (at ?t ?from) (city_of ?from ?c) (city_of ?to ?c) (not (= ?from ?to)))
    :effect (and (not (at ?t ?from)) (at ?t ?to)))
  (:action fly
    :parameters (?p - plane ?from ?to - airport)
    :precondition (and (at ?p ?from) (not (= ?from ?to)))
    :effect (and (not (at ?p ?from)) (at ?p ?to)))
  (:action load
    :parameters (?p - package ?v - vehicle ?l - location)
    :precondition (and (in ?p ?l) (at ?v ?l))
    :effect (and (not (in ?p ?l)) (in ?p ?v)))
  (:action unload
    :parameters (?p - package ?v - vehicle ?l - location)
    :precondition (and (in ?p ?v) (at ?v ?l))
    :effect (and (not (in ?p ?v)) (in ?p ?l))))
