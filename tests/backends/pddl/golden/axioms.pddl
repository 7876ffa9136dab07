; Emitted by cdlc from the CDL domain "derived".
(define (domain derived)
  (:requirements :strips :typing :negative-preconditions :disjunctive-preconditions :equality :existential-preconditions :universal-preconditions :conditional-effects :derived-predicates)
  (:types T)
  (:predicates
    (on ?x ?y - T)
    (wet ?x - T)
    (lamp)
    (clear ?x - T)
    (top ?y - T))
  (:derived (clear ?x - T)
    (not (exists (?t - T) (on ?t ?x))))
  (:derived (top ?y - T)
    (and (clear ?y) (not (wet ?y))))
  (:action lift  ; lift
    :parameters (?x ?y - T)
    :precondition (and
      (on ?x ?y)
      (not (exists (?t - T) (on ?t ?x)))
      (not (wet ?x))
      (lamp))
    :effect (and
      (not (on ?x ?y))
      (when (exists (?t - T) (and (not (= ?t ?x)) (on ?t ?y))) (not (wet ?y)))
      (when (not (exists (?t - T) (and (not (= ?t ?x)) (on ?t ?y)))) (wet ?y)))))

; Emitted by cdlc from the CDL problem "derived".
(define (problem derived)
  (:domain derived)
  (:objects
    a b - T)
  (:init
    (on a b)
    (lamp))
  (:goal (and
    (top b)
    (forall (?t - T) (clear ?t)))))
