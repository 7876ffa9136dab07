(define (domain gripper)
  (:requirements :strips :typing :negative-preconditions :equality)
  (:types room ball gripper)
  (:predicates
    (robot_at ?r - room)
    (at ?b - ball ?r - room)
    (carries ?g - gripper ?b - ball)
    (free ?g - gripper))
  (:action move
    :parameters (?from ?to - room)
    :precondition (and (robot_at ?from) (not (= ?from ?to)))
    :effect (and (robot_at ?to) (not (robot_at ?from))))
  (:action pick
    :parameters (?b - ball ?r - room ?g - gripper)
    :precondition (and (at ?b ?r) (robot_at ?r) (free ?g))
    :effect (and (carries ?g ?b) (not (at ?b ?r)) (not (free ?g))))
  (:action drop
    :parameters (?b - ball ?r - room ?g - gripper)
    :precondition (and (carries ?g ?b) (robot_at ?r))
    :effect (and (at ?b ?r) (free ?g) (not (carries ?g ?b)))))
