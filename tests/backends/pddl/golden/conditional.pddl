; Emitted by cdlc from the CDL domain "conditional".
(define (domain conditional)
  (:requirements :strips :typing :negative-preconditions :disjunctive-preconditions :equality :conditional-effects)
  (:types T)
  (:constants home - T)
  (:predicates
    (p ?x - T)
    (q ?x - T)
    (on ?x ?y - T))
  (:action toggle  ; toggle_it
    :parameters (?x - T)
    :precondition (and)
    :effect (and
      (not (p ?x))
      (when (not (p ?x)) (p ?x))
      (when (not (and (not (p ?x)) (q home))) (not (q ?x)))
      (when (and (not (p ?x)) (q home)) (q ?x))))
  (:action swap  ; swap_them
    :parameters (?x ?y - T)
    :precondition (and)
    :effect (and
      (when (and (not (= ?x ?y)) (not (p ?y))) (not (p ?x)))
      (when (and (not (= ?x ?y)) (p ?y)) (p ?x))
      (when (not (p ?x)) (not (p ?y)))
      (when (p ?x) (p ?y))
      (when (not (= ?x ?y)) (on ?x ?y))
      (not (on ?y ?x))))
  (:action mark  ; mark_other
    :parameters (?x ?y - T)
    :precondition (and
      (not (or (= ?x ?y) (p ?y))))
    :effect (and
      (p ?x)
      (when (not (or (q ?x) (= ?x home) (p home))) (not (q ?y)))
      (when (or (q ?x) (= ?x home) (p home)) (q ?y)))))

; Emitted by cdlc from the CDL problem "conditional".
(define (problem conditional)
  (:domain conditional)
  (:objects
    a b - T)
  (:init
    (p a))
  (:goal (and
    (p b)
    (not (p a))
    (q b))))
