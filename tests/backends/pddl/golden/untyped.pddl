; Emitted by cdlc from the CDL domain "untyped".
(define (domain untyped)
  (:requirements :strips :negative-preconditions :action-costs)
  (:predicates
    (hot)
    (near ?a ?b))
  (:functions
    (total-cost) - number)
  (:action press  ; press_it
    :parameters ()
    :precondition (and
      (not (hot)))
    :effect (and
      (hot)
      (increase (total-cost) 1)))
  (:action approach  ; approach
    :parameters (?a ?b)
    :precondition (and
      (near ?a ?b))
    :effect (and
      (near ?b ?a))))

; Emitted by cdlc from the CDL problem "untyped".
(define (problem untyped)
  (:domain untyped)
  (:objects
    a b)
  (:init
    (near a b)
    (= (total-cost) 0))
  (:goal (and
    (near b a)
    (hot)))
  (:metric minimize (total-cost)))
