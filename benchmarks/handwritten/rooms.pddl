; The tutorial's domain as a person writes it.
(define (domain rooms)
  (:requirements :strips :typing)
  (:types room ball)
  (:predicates
    (robot_in ?r - room)
    (ball_in ?b - ball ?r - room)
    (carrying ?b - ball)
    (free))
  (:action go
    :parameters (?from ?to - room)
    :precondition (robot_in ?from)
    :effect (and (not (robot_in ?from)) (robot_in ?to)))
  (:action pick
    :parameters (?b - ball ?r - room)
    :precondition (and (ball_in ?b ?r) (free) (robot_in ?r))
    :effect (and (not (ball_in ?b ?r)) (carrying ?b) (not (free))))
  (:action drop
    :parameters (?b - ball ?r - room)
    :precondition (and (carrying ?b) (robot_in ?r))
    :effect (and (not (carrying ?b)) (ball_in ?b ?r) (free))))
