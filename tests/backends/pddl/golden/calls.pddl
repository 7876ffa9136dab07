; Emitted by cdlc from the CDL domain "calls".
(define (domain calls)
  (:requirements :strips :typing :negative-preconditions :disjunctive-preconditions :equality :conditional-effects :action-costs)
  (:types T empty)
  (:constants home - T)
  (:predicates
    (p ?x - T)
    (q ?x - T))
  (:functions
    (total-cost) - number)
  (:action twice  ; twice
    :parameters (?y ?x - T)
    :precondition (and)
    :effect (and
      (p ?x)
      (increase (total-cost) 2)))
  (:action silent  ; silent
    :parameters (?x - T)
    :precondition (and)
    :effect (and
      (q ?x)))
  (:action put  ; careless
    :parameters (?y - T)
    :precondition (and)
    :effect (and
      (not (q ?y))
      (increase (total-cost) 1)))
  (:action both  ; both
    :parameters (?x - T)
    :precondition (and)
    :effect (and
      (not (p ?x))
      (increase (total-cost) 1)))
  (:action opens  ; opens
    :parameters (?x ?y - T)
    :precondition (and)
    :effect (and
      (when (not (q ?y)) (not (p ?x)))
      (when (q ?y) (p ?x))
      (p ?y)
      (when (not (or (= ?x ?y) (q ?y))) (not (q ?x)))
      (when (or (= ?x ?y) (q ?y)) (q ?x))
      (increase (total-cost) 2)))
  (:action hiding  ; hiding
    :parameters (?x ?y ?y-2 - T)
    :precondition (and
      (p ?x)
      (q ?y-2)
      (p ?y))
    :effect (and
      (not (q ?x))
      (increase (total-cost) 1))))

; Emitted by cdlc from the CDL problem "calls".
(define (problem calls)
  (:domain calls)
  (:objects
    a b - T)
  (:init
    (= (total-cost) 0))
  (:goal (and
    (p a)
    (q b)))
  (:metric minimize (total-cost)))
