; Emitted by cdlc from the CDL domain "objects".
(define (domain objects)
  (:requirements :strips :typing :negative-preconditions :disjunctive-preconditions :equality :existential-preconditions :conditional-effects :action-costs)
  (:types
    room - place
    item place - object)
  (:constants home - room)
  (:predicates
    (loc ?x - item ?value - place)
    (exit ?r - room ?value - place)
    (clear ?p - place)
    (heavy ?x - item))
  (:functions
    (total-cost) - number)
  (:action move  ; r_loc
    :parameters (?x - item ?to ?old - place)
    :precondition (and
      (clear ?to)
      (not (= ?old ?to))
      (loc ?x ?old))
    :effect (and
      (clear ?old)
      (not (clear ?to))
      (not (loc ?x ?old))
      (loc ?x ?to)
      (increase (total-cost) 1)))
  (:action r_home  ; r_home
    :parameters (?x - item ?from - place)
    :precondition (and
      (loc ?x ?from))
    :effect (and
      (clear ?from)
      (not (loc ?x ?from))
      (loc ?x home)
      (increase (total-cost) 1)))
  (:action push  ; r_push
    :parameters (?x ?y - item ?loc - place)
    :precondition (and
      (loc ?y ?loc))
    :effect (and
      (forall (?loc-2 - place) (when (and (heavy ?x) (loc ?x ?loc-2)) (not (loc ?x ?loc-2))))
      (when (heavy ?x) (loc ?x ?loc))
      (when (not (heavy ?x)) (not (clear ?loc)))
      (increase (total-cost) 1)))
  (:action sweep  ; r_sweep
    :parameters ()
    :precondition (and
      (exists (?i - item) (exists (?p - place) (and (loc ?i ?p) (clear ?p)))))
    :effect (and
      (forall (?x - item ?loc - place) (when (loc ?x ?loc) (not (clear ?loc))))
      (forall (?r - room ?exit - place) (when (exit ?r ?exit) (not (exit ?r ?exit))))
      (forall (?r - room) (when (and (not (exists (?i - item) (exists (?p - place) (and (loc ?i ?p) (exit ?r ?p))))) (exists (?p - place) (and (exit ?r ?p) (clear ?p)))) (exit ?r home)))
      (forall (?r - room) (when (not (and (not (exists (?i - item) (exists (?p - place) (and (loc ?i ?p) (exit ?r ?p))))) (exists (?p - place) (and (exit ?r ?p) (clear ?p))))) (exit ?r ?r)))
      (increase (total-cost) 1)))
  (:action swap  ; swap
    :parameters (?x ?y - item ?old ?old_2 - place)
    :precondition (and
      (loc ?y ?old)
      (loc ?x ?old_2))
    :effect (and
      (not (loc ?x ?old_2))
      (when (not (= ?x ?y)) (loc ?x ?old))
      (not (loc ?y ?old))
      (loc ?y ?old_2))))

; Emitted by cdlc from the CDL problem "objects".
(define (problem objects)
  (:domain objects)
  (:objects
    a b - item
    shelf - place)
  (:init
    (loc a home)
    (loc b home)
    (exit home shelf)
    (clear shelf)
    (= (total-cost) 0))
  (:goal (and
    (loc a shelf)
    (exists (?p - place) (and (loc b ?p) (exit home ?p)))
    (not (exists (?p - place) (and (loc a ?p) (clear ?p))))))
  (:metric minimize (total-cost)))
