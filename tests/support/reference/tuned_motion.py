"""An independent reference for parameters that change during a run: the Taylor integrator, which goes on with
new ones from where it stands."""

from support.reference.integrator import Reference


class TunedMotion(Reference):
    """A ball of 0.1 m and 1 kg meets a fixed sphere of 0.5 m at the origin; `values` by their FMI names."""

    def __init__(self, values, position, velocity):
        start = {"source.center": position, "source.initial_velocity": velocity}
        super().__init__({**start, "contact.location": "outside", **values}, "sphere")

    def energies(self):
        """Potential and stored energy"""
        gravity = self.vector("gravity")
        height = sum(g * x for g, x in zip(gravity, self.position["source"], strict=True))
        return self.stored_energy() - height

    def change(self, values):
        before = self.energies()
        self.values |= values
        self.penalty = self.values["contact.penalty_factor"]
        self.viscous = self.values["contact.viscous_penalty_factor"]
        self.dashpot = self.values["contact.dashpot"]
        self.external_work += self.energies() - before
        if self.touching:
            self.begin_law()
