; Emitted by cdlc from the CDL domain "foreach".
(define (domain foreach)
  (:requirements :strips :typing :negative-preconditions :disjunctive-preconditions :equality :existential-preconditions :universal-preconditions :conditional-effects :action-costs)
  (:types
    U - T
    T - object)
  (:constants home - U)
  (:predicates
    (p ?x - T)
    (on ?x ?y - T)
    (wet ?x - T))
  (:functions
    (total-cost) - number)
  (:action shake  ; shake_off
    :parameters (?x - T)
    :precondition (and)
    :effect (and
      (forall (?y - T) (not (on ?y ?x)))
      (forall (?y - U) (when (and (wet ?y) (not (= ?x ?y))) (p ?y)))
      (increase (total-cost) 1)))
  (:action dry  ; dry_all
    :parameters ()
    :precondition (and)
    :effect (and
      (forall (?z - T) (when (not (= ?z home)) (not (wet ?z))))
      (when (not (p home)) (not (wet home)))
      (when (p home) (wet home))
      (increase (total-cost) 1)))
  (:action invert  ; invert
    :parameters (?x - T)
    :precondition (and
      (forall (?u - U) (not (on ?u ?x)))
      (or (not (p ?x)) (wet ?x)))
    :effect (and
      (when (wet ?x) (not (p ?x)))
      (when (and (wet ?x) (not (p ?x))) (p ?x))
      (when (not (wet ?x)) (wet ?x)))))

; Emitted by cdlc from the CDL problem "foreach".
; Names that PDDL does not take or tell apart:
;   u is u-2
(define (problem foreach)
  (:domain foreach)
  (:objects
    a - T
    u-2 - U)
  (:init
    (on u-2 a)
    (wet home)
    (wet a)
    (wet u-2)
    (= (total-cost) 0))
  (:goal (and
    (not (wet home))
    (p u-2)
    (not (exists (?t - T) (on ?t a)))))
  (:metric minimize (total-cost)))
