; Emitted by cdlc from the CDL domain "blocks".
(define (domain blocks)
  (:requirements :strips :typing)
  (:types block)
  (:predicates
    (on ?x ?y - block)
    (on_table ?x - block)
    (clear ?x - block)
    (holding ?x - block)
    (handempty))
  (:action pickup_table  ; r_holding_from_table
    :parameters (?x - block)
    :precondition (and
      (on_table ?x)
      (clear ?x)
      (handempty))
    :effect (and
      (not (on_table ?x))
      (not (clear ?x))
      (not (handempty))
      (holding ?x)))
  (:action unstack  ; r_holding_from_stack, r_clear
    :parameters (?x ?y - block)
    :precondition (and
      (on ?x ?y)
      (clear ?x)
      (handempty))
    :effect (and
      (not (on ?x ?y))
      (not (clear ?x))
      (not (handempty))
      (holding ?x)
      (clear ?y)))
  (:action place_table  ; r_clear_from_holding, r_handempty, r_on_table
    :parameters (?x - block)
    :precondition (and
      (holding ?x))
    :effect (and
      (not (holding ?x))
      (on_table ?x)
      (clear ?x)
      (handempty)))
  (:action stack  ; r_on
    :parameters (?x ?y - block)
    :precondition (and
      (clear ?y)
      (holding ?x))
    :effect (and
      (not (holding ?x))
      (not (clear ?y))
      (on ?x ?y)
      (clear ?x)
      (handempty))))

; Emitted by cdlc from the CDL problem "sussman".
(define (problem sussman)
  (:domain blocks)
  (:objects
    A B C - block)
  (:init
    (on C A)
    (on_table A)
    (on_table B)
    (clear B)
    (clear C)
    (handempty))
  (:goal (and
    (on A B)
    (on B C))))
