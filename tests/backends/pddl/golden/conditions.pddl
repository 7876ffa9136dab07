; Emitted by cdlc from the CDL domain "conditions".
(define (domain conditions)
  (:requirements :strips :typing :negative-preconditions :disjunctive-preconditions :equality :existential-preconditions :universal-preconditions)
  (:types
    U - T
    T - object)
  (:predicates
    (p ?x - T)
    (q ?x - T)
    (on ?x ?y - T)
    (flag))
  (:action go  ; act
    :parameters (?x ?y - T)
    :precondition (and
      (not (= ?x ?y))
      (not (p ?x))
      (or (p ?y) (q ?y) (not (flag)))
      (or (and (p ?x) (not (q ?x))) (and (not (p ?x)) (q ?x)))
      (not (or (and (p ?x) (not (flag))) (and (not (p ?x)) (flag))))
      (or (and (flag) (q ?x)) (and (not (flag)) (q ?y)))
      (not (and (p ?x) (q ?x)))
      (forall (?u - U) (or (on ?u ?x) (= ?u ?x)))
      (exists (?t - T ?u - U) (and (on ?t ?u) (not (p ?t))))
      (not (exists (?u - U) (and (p ?u) (q ?u)))))
    :effect (and
      (q ?x))))

; Emitted by cdlc from the CDL problem "conditions".
; Names that PDDL does not take or tell apart:
;   u is u-2
(define (problem conditions)
  (:domain conditions)
  (:objects
    a - T
    u-2 - U)
  (:init
    (p u-2))
  (:goal (and
    (or (forall (?t - T) (or (q ?t) (exists (?u - U) (on ?u ?t)))) (not (and (q a) (flag)))))))
