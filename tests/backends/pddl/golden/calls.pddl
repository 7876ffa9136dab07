; Emitted by cdlc from the CDL domain "calls".
(define (domain calls)
  (:requirements :strips :typing :negative-preconditions :disjunctive-preconditions :equality :conditional-effects)
  (:types T empty)
  (:constants home - T)
  (:predicates
    (p ?x - T)
    (q ?x - T))
  (:action twice  ; twice
    :parameters (?y ?x - T)
    :precondition (and)
    :effect (and
      (p ?x)))
  (:action silent  ; silent
    :parameters (?x - T)
    :precondition (and)
    :effect (and
      (q ?x)))
  (:action put  ; careless
    :parameters (?y - T)
    :precondition (and)
    :effect (and
      (not (q ?y))))
  (:action both  ; both
    :parameters (?x - T)
    :precondition (and)
    :effect (and
      (not (p ?x))))
  (:action opens  ; opens
    :parameters (?x ?y - T)
    :precondition (and)
    :effect (and
      (when (not (q ?y)) (not (p ?x)))
      (when (q ?y) (p ?x))
      (p ?y)
      (when (not (or (= ?x ?y) (q ?y))) (not (q ?x)))
      (when (or (= ?x ?y) (q ?y)) (q ?x))))
  (:action hiding  ; hiding
    :parameters (?x ?y ?y-2 - T)
    :precondition (and
      (p ?x)
      (q ?y-2)
      (p ?y))
    :effect (and
      (not (q ?x)))))

; Emitted by cdlc from the CDL problem "calls".
(define (problem calls)
  (:domain calls)
  (:objects
    a b - T)
  (:init)
  (:goal (and
    (p a)
    (q b))))
