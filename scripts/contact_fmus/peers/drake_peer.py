"""Drake: point contact of a MultibodyPlant.

Continuous plant: stiffness times overlap, times 1 + dissipation times its rate (Hunt and Crossley). Without
dissipation that is the penalty law: the same on P1; a dashpot cannot be had. CENIC, the error-controlled
integrator for contact, makes convex steps of first order of that plant. Discrete plant with the SAP approximation:
a linear spring and a dashpot (relaxation time p_nv/p_n) that never pulls, in implicit steps of first order:
similar. Stiffnesses of two bodies act in series, relaxation times add up."""

from .problems import Run

LARGEST_STEP = 0.1  # s
SLIDE_MASS = 1e-9  # kg: CENIC refuses massless bodies. On P1, where the law is the same, none of the slides moves.


def material(pydrake, problem):
    properties = pydrake.ProximityProperties()
    pydrake.AddContactMaterial(
        dissipation=0.0,
        point_stiffness=2 * problem.stiffness,
        friction=pydrake.CoulombFriction(0.0, 0.0),
        properties=properties,
    )
    properties.AddProperty("material", "relaxation_time", problem.damping / problem.stiffness / 2)
    return properties


def scene(pydrake, problem, time_step):
    """The diagram and its plant; the ball moves on three slides, so that rotation costs nothing."""
    builder = pydrake.DiagramBuilder()
    config = pydrake.MultibodyPlantConfig(time_step=time_step, contact_model="point")
    config.discrete_contact_approximation = "sap"
    config.sap_near_rigid_threshold = 0.0  # else the stiffness is lowered where steps are large
    plant, _ = pydrake.AddMultibodyPlant(config, builder)
    here = pydrake.RigidTransform()
    wall, ball_shape = pydrake.Sphere(problem.wall_radius), pydrake.Sphere(problem.radius)
    plant.RegisterCollisionGeometry(plant.world_body(), here, wall, "wall", material(pydrake, problem))
    inertia = pydrake.SpatialInertia.SolidSphereWithMass(problem.mass, problem.radius)
    ball = plant.AddRigidBody("ball", inertia)
    plant.RegisterCollisionGeometry(ball, here, ball_shape, "ball", material(pydrake, problem))
    frame, slide = plant.world_frame(), pydrake.SpatialInertia.SolidSphereWithMass(SLIDE_MASS, problem.radius)
    for name, axis in (("x", [1, 0, 0]), ("y", [0, 1, 0]), ("z", [0, 0, 1])):
        body = ball if name == "z" else plant.AddRigidBody(f"slide {name}", slide)
        plant.AddJoint(pydrake.PrismaticJoint(name, frame, body.body_frame(), axis))
        frame = body.body_frame()
    plant.mutable_gravity_field().set_gravity_vector([0, 0, -problem.gravity])
    plant.Finalize()
    return builder.Build(), plant


def prepare(problem, case):
    import pydrake.all as pydrake

    discrete = case.integrator == "SAP"
    diagram, plant = scene(pydrake, problem, case.parameter if discrete else 0.0)
    simulator = pydrake.Simulator(diagram)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetPositions(context, problem.position)
    plant.SetVelocities(context, problem.velocity)
    if not discrete:
        config = pydrake.SimulatorConfig(
            integration_scheme=case.integrator,
            max_step_size=LARGEST_STEP,
            accuracy=case.parameter,
            use_error_control=True,
        )
        pydrake.ApplySimulatorConfig(config, simulator)
    simulator.Initialize()

    def advance():
        simulator.AdvanceTo(problem.end)

    def state():
        context = plant.GetMyContextFromRoot(simulator.get_context())
        return [*plant.GetPositions(context), *plant.GetVelocities(context)]

    return Run(advance, state)
