; Emitted by cdlc from the CDL domain "untyped".
(define (domain untyped)
  (:requirements :strips :negative-preconditions)
  (:predicates
    (hot)
    (near ?a ?b))
  (:action press  ; press_it
    :parameters ()
    :precondition (and
      (not (hot)))
    :effect (and
      (hot)))
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
    (near a b))
  (:goal (and
    (near b a)
    (hot))))
