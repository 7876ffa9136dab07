; Emitted by cdlc from the CDL domain "2 Bad; names".
; Names that PDDL does not take or tell apart:
;   number is number-2
;   block is block-2
;   on is on-2
;   when is when-2
;   increase is increase-2
;   _hidden is n_hidden
;   home is home-2
;   move is move-2
;   _ is n_
(define (domain n2-Bad-names)
  (:requirements :strips :typing :negative-preconditions :disjunctive-preconditions :existential-preconditions :action-costs)
  (:types number-2 Block block-2)
  (:constants Home - Block home-2 - block-2)
  (:predicates
    (On ?X ?x-2 - Block)
    (on-2 ?n_ - Block)
    (when-2 ?n_x - Block)
    (and_ ?n_x - Block)
    (at ?b - block-2)
    (exists_ ?n - number-2)
    (goal)
    (increase-2)
    (n_hidden ?b - Block))
  (:functions
    (total-cost) - number)
  (:action Move  ; act
    :parameters (?n_a ?A - Block)
    :precondition (and
      (when-2 ?n_a)
      (not (exists (?b ?b-2 - Block) (and (On ?b ?b-2) (On ?b-2 ?n_a)))))
    :effect (and
      (On ?n_a ?A)
      (goal)
      (increase-2)
      (increase (total-cost) 1)))
  (:action move-2  ; Act
    :parameters (?a - Block)
    :precondition (and)
    :effect (and
      (n_hidden ?a)
      (not (when-2 ?a))
      (increase (total-cost) 1)))
  (:action n_  ; _
    :parameters (?b - block-2)
    :precondition (and)
    :effect (and
      (at ?b))))

; Emitted by cdlc from the CDL problem "and".
; Names that PDDL does not take or tell apart:
;   a is a-2
;   _b is n_b
(define (problem and)
  (:domain n2-Bad-names)
  (:objects
    A a-2 - Block
    n_b not_ - block-2)
  (:init
    (when-2 Home)
    (when-2 A)
    (= (total-cost) 0))
  (:goal (and
    (On A a-2)
    (at n_b)
    (at home-2)
    (goal)))
  (:metric minimize (total-cost)))
