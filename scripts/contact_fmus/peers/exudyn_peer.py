"""Exudyn: its own contact of two spheres, or the law as a symbolic user function of a spring-damper.

Built-in contact (`ObjectContactSphereSphere`, linear model): stiffness times overlap plus damping times its
rate, never clipped: the same law; an exponent makes it Hertz's. It decides once a step whether the spheres
touch, which shows where the dashpot makes the force jump. A hollow cylinder it has not; a hollow sphere that
slides along the axis with the ball, so that the ball is always in its middle plane, is one.

User function: the same law in Exudyn's symbolic expressions, evaluated in C++ without Python."""

import itertools

from contact_fmus.report.measure import RELATIVE_TOLERANCE

from .problems import Cradle, Run, steps_of


def ball_and_built_in_contact(exudyn, system, problem):
    from exudyn.utilities import Node1D, ObjectMass1D

    start = {"referencePosition": list(problem.position), "initialVelocity": list(problem.velocity)}
    ball = rigid_ball(exudyn, system, problem, gravity=[0, 0, -problem.gravity], **start)
    if problem.inside:
        y_axis = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]  # turns the x axis into it
        place, speed = [problem.position[1]], [problem.velocity[1]]
        node = Node1D(referenceCoordinates=[0.0], initialCoordinates=place, initialVelocities=speed)
        wall = ObjectMass1D(mass=1.0, nodeNumber=system.AddNode(node), referenceRotation=y_axis)
        wall = system.AddObject(wall)
    else:
        wall = system.CreateGround(referencePosition=[0, 0, 0])
    radii, more = [problem.radius, problem.wall_radius], {"isHollowSphere1": problem.inside}
    more["contactDamping"] = problem.damping
    return [ball], touch(system, problem, (ball, wall), radii, problem.touching, **more)


def rigid_ball(exudyn, system, problem, **start):
    """A ball that does not turn: Euler parameters exclude explicit methods"""
    inertia, upright = exudyn.utilities.InertiaSphere(problem.mass, problem.radius), exudyn.NodeType.RotationRxyz
    return system.CreateRigidBody(inertia=inertia, nodeType=upright, **start)


def touch(system, problem, bodies, radii, touching, **more):
    from exudyn.utilities import MarkerBodyRigid, NodeGenericData, ObjectContactSphereSphere

    state = [-1e-15 if touching else 1.0, 0, 0, 0]  # the first is the gap of the step before
    data = system.AddNode(NodeGenericData(numberOfDataCoordinates=4, initialCoordinates=state))
    markers = [system.AddMarker(MarkerBodyRigid(bodyNumber=body)) for body in bodies]
    contact = ObjectContactSphereSphere(
        markerNumbers=markers, nodeNumber=data, spheresRadii=radii, contactStiffness=problem.stiffness, **more
    )
    system.AddObject(contact)
    return contact


def cradle(exudyn, system, problem):
    places = [[2.0 * problem.radius * k, 0, 0] for k in range(problem.balls)]
    speeds = [[0.0 if k else problem.speed, 0, 0] for k in range(problem.balls)]
    starts = zip(places, speeds, strict=True)
    balls = [rigid_ball(exudyn, system, problem, referencePosition=x, initialVelocity=v) for x, v in starts]
    law = {"contactStiffnessExponent": problem.power}
    pairs = itertools.pairwise(balls)
    return balls, [touch(system, problem, pair, [problem.radius] * 2, True, **law) for pair in pairs]


def law(exudyn, problem):
    """The force between ground and ball as Exudyn's symbolic expressions."""
    symbolic = exudyn.symbolic
    across = 0.0 if problem.inside else 1.0
    side = -1.0 if problem.inside else 1.0
    touch = problem.touching_distance

    def force(_system, _time, _item, r, v, stiffness, damping, _offset):
        distance = symbolic.sqrt(r[0] * r[0] + across * r[1] * r[1] + r[2] * r[2])
        rate = (r[0] * v[0] + across * r[1] * v[1] + r[2] * v[2]) / distance
        pull = stiffness[0] * (distance - touch) + damping[0] * rate
        pull = symbolic.IfThenElse(side * (distance - touch) < 0, pull, symbolic.Real(0.0)) / distance
        return symbolic.Vector([pull * r[0], across * pull * r[1], pull * r[2]])

    return force


def ball_and_user_function(exudyn, system, problem):
    from exudyn.utilities import CreateSymbolicUserFunction, MarkerBodyPosition, ObjectConnectorCartesianSpringDamper

    start = {"referencePosition": list(problem.position), "initialVelocity": list(problem.velocity)}
    ball = system.CreateMassPoint(mass=problem.mass, gravity=[0, 0, -problem.gravity], **start)
    ground = system.CreateGround(referencePosition=[0, 0, 0])
    connector = system.AddObject(
        ObjectConnectorCartesianSpringDamper(
            markerNumbers=[system.AddMarker(MarkerBodyPosition(bodyNumber=body)) for body in (ground, ball)],
            stiffness=[problem.stiffness] * 3,
            damping=[problem.damping] * 3,
            springForceUserFunction=0,
        )
    )
    name = "springForceUserFunction"
    function = CreateSymbolicUserFunction(system, law(exudyn, problem), name, connector)
    system.SetObjectParameter(connector, name, function)
    return [ball], function


def settings(exudyn, problem, case):
    result = exudyn.SimulationSettings()
    integration = result.timeIntegration
    integration.endTime = problem.end
    if case.setting.startswith(RELATIVE_TOLERANCE):
        integration.automaticStepSize = True
        integration.numberOfSteps = steps_of(problem.end, 0.01)[0]  # the largest step
        integration.minimumStepSize = 1e-13
        integration.relativeTolerance, integration.absoluteTolerance = case.parameter, 1e-3 * case.parameter
    else:
        integration.automaticStepSize = False
        integration.numberOfSteps = steps_of(problem.end, case.parameter)[0]
    integration.generalizedAlpha.spectralRadius = 1.0  # adds no damping of its own
    result.solution.file.write = False
    result.solution.sensors.writePeriod = problem.end
    return result, getattr(exudyn.DynamicSolverType, case.integrator)


def prepare(problem, case):
    import exudyn.utilities

    container = exudyn.SystemContainer()
    system = container.AddSystem()
    build = ball_and_built_in_contact if case.setting.endswith("built-in contact") else ball_and_user_function
    balls, kept = (cradle if isinstance(problem, Cradle) else build)(exudyn, system, problem)
    system.Assemble()
    options, solver = settings(exudyn, problem, case)

    def advance():
        system.SolveDynamic(options, solverType=solver)

    def state(_alive=(container, kept)):  # neither may go before the run ends
        wanted = (exudyn.OutputVariableType.Position, exudyn.OutputVariableType.Velocity)
        told, now = system.GetObjectOutputBody, exudyn.ConfigurationType.Current
        return [x for what in wanted for ball in balls for x in told(ball, what, [0, 0, 0], now).tolist()]

    return Run(advance, state)
