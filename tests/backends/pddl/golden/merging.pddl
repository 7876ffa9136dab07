; Emitted by cdlc from the CDL domain "merging".
(define (domain merging)
  (:requirements :strips :typing :negative-preconditions :equality :universal-preconditions :conditional-effects :action-costs)
  (:types
    U - T
    T - object)
  (:predicates
    (p ?x - T)
    (q ?x - T)
    (r ?x - T)
    (on ?x ?y - T))
  (:functions
    (total-cost) - number)
  (:action go  ; first, second
    :parameters (?x ?b - T)
    :precondition (and
      (q ?x)
      (on ?x ?b)
      (forall (?t - T) (not (on ?t ?t))))
    :effect (and
      (p ?x)
      (not (q ?x))
      (not (on ?x ?b))
      (increase (total-cost) 1)))
  (:action still  ; still, still_too
    :parameters (?a ?b ?c - T)
    :precondition (and
      (on ?a ?b)
      (on ?b ?c))
    :effect (and
      (r ?a)))
  (:action put  ; narrow
    :parameters (?x - U)
    :precondition (and)
    :effect (and
      (p ?x)
      (increase (total-cost) 1)))
  (:action wide  ; wide
    :parameters (?x - T)
    :precondition (and)
    :effect (and
      (p ?x)
      (increase (total-cost) 1)))
  (:action last_adds  ; last_adds
    :parameters (?x ?y - T)
    :precondition (and)
    :effect (and
      (not (p ?x))
      (p ?y)
      (increase (total-cost) 1)))
  (:action last_deletes  ; last_deletes
    :parameters (?x ?y - T)
    :precondition (and)
    :effect (and
      (when (not (= ?x ?y)) (p ?y))
      (not (p ?x))
      (increase (total-cost) 1))))

; Emitted by cdlc from the CDL problem "merging".
; Names that PDDL does not take or tell apart:
;   u is u-2
(define (problem merging)
  (:domain merging)
  (:objects
    a b - T
    u-2 - U)
  (:init
    (q a)
    (on a b)
    (= (total-cost) 0))
  (:goal (and
    (p a)
    (r b)))
  (:metric minimize (total-cost)))
