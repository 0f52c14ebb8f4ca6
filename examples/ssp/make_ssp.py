#!/usr/bin/env python3
"""Writes tube.ssp: a ball falls in a tube that hangs on a spring, two FMUs wired by an .ssd (SSP 1.0).

python examples/ssp/make_ssp.py [FOLDER OF FMUS] [SSP]      default build/fmus tube.ssp

Carriage is SphereSphere.fmu: a body of 1 kg that presses on a soft sphere swings as on a spring. Its
motion is that of the tube. Tube is SphereCylinder.fmu: the ball in the tube, whose motion is prescribed. The
force of the ball on the tube goes back to the carriage. Everything moves along z.
"""

import sys
import zipfile
from pathlib import Path

# m, kg, N/m, N s/m, m/s2. The carriage starts at rest 20 mm above where it would rest.
MASS, SPRING, GRAVITY, RAISED = 1.0, 100.0, 9.81, 0.02
BALL, STIFFNESS, DAMPING = 0.1, 1e4, 5.0
CLEARANCE, HEIGHT = 0.45, -0.35  # of the ball in the tube; where it starts, seen from the tube's axis

# Items of enumerations by their numbers, as FMI 2.0 sets them: contact.method, destination.motion,
# contact.location, contact.dashpot.
PENALTY, PRESCRIBED, INSIDE, UNCLAMPED = 1, 2, 3, 2
START = {
    "Carriage.source.radius": 1.0,
    "Carriage.destination.radius": 5.0,
    "Carriage.source.mass": MASS,
    "Carriage.source.center[3]": 6.0 - MASS * GRAVITY / SPRING + RAISED,
    "Carriage.contact.method": PENALTY,
    "Carriage.contact.penalty_factor": SPRING,
    "Carriage.solver.relative_tolerance": 1e-10,
    "Tube.source.radius": 0.05,
    "Tube.destination.radius": 0.05 + CLEARANCE,
    "Tube.source.mass": BALL,
    "Tube.source.center[1]": 0.0,
    "Tube.source.center[3]": HEIGHT,
    "Tube.destination.axis[2]": 1.0,
    "Tube.destination.axis[3]": 0.0,
    "Tube.destination.motion": PRESCRIBED,
    "Tube.contact.location": INSIDE,
    "Tube.contact.dashpot": UNCLAMPED,
    "Tube.contact.penalty_factor": STIFFNESS,
    "Tube.contact.viscous_penalty_factor": DAMPING,
    "Tube.solver.relative_tolerance": 1e-10,
}
COMPONENTS = {"Carriage": "SphereSphere.fmu", "Tube": "SphereCylinder.fmu"}
CONNECTIONS = [
    ("Carriage", "source.displacement[3]", "Tube", "destination.prescribed_displacement[3]"),
    ("Carriage", "source.velocity[3]", "Tube", "destination.prescribed_velocity[3]"),
    ("Tube", "contact.destination_force[3]", "Carriage", "source.external_force[3]"),
]
RESULTS = [("Tube", "source.position[3]")]  # outputs that nobody is wired to
SSP = "http://ssp-standard.org/SSP1/"


def parameters() -> str:
    rows = []
    for name, value in START.items():
        kind = "Integer" if isinstance(value, int) else "Real"
        rows.append(f'    <ssv:Parameter name="{name}"><ssv:{kind} value="{value!r}"/></ssv:Parameter>\n')
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<ssv:ParameterSet xmlns:ssv="{SSP}SystemStructureParameterValues" version="1.0" name="start">
  <ssv:Parameters>
{"".join(rows)}  </ssv:Parameters>
</ssv:ParameterSet>
"""


def component(name: str) -> str:
    ends = [(output, "output") for source, output, _, _ in CONNECTIONS if source == name]
    ends += [(given, "input") for _, _, target, given in CONNECTIONS if target == name]
    ends += [(output, "output") for source, output in RESULTS if source == name]
    rows = [
        f'          <ssd:Connector name="{connector}" kind="{kind}"><ssc:Real/></ssd:Connector>\n'
        for connector, kind in ends
    ]
    kind = "application/x-fmu-sharedlibrary"
    return f"""      <ssd:Component name="{name}" type="{kind}" source="resources/{COMPONENTS[name]}">
        <ssd:Connectors>
{"".join(rows)}        </ssd:Connectors>
      </ssd:Component>
"""


def structure() -> str:
    names = ("startElement", "startConnector", "endElement", "endConnector")
    wires = []
    for one in CONNECTIONS:
        ends = " ".join(f'{name}="{value}"' for name, value in zip(names, one, strict=True))
        wires.append(f"      <ssd:Connection {ends}/>\n")
    kind = "application/x-ssp-parameter-set"
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription xmlns:ssc="{SSP}SystemStructureCommon"
    xmlns:ssd="{SSP}SystemStructureDescription" version="1.0" name="tube">
  <ssd:System name="tube">
    <ssd:ParameterBindings>
      <ssd:ParameterBinding type="{kind}" source="resources/start.ssv"/>
    </ssd:ParameterBindings>
    <ssd:Elements>
{"".join(map(component, COMPONENTS))}    </ssd:Elements>
    <ssd:Connections>
{"".join(wires)}    </ssd:Connections>
  </ssd:System>
  <ssd:DefaultExperiment startTime="0.0" stopTime="0.5"/>
</ssd:SystemStructureDescription>
"""


def main(fmus: str = "build/fmus", ssp: str = "tube.ssp") -> None:
    with zipfile.ZipFile(ssp, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("SystemStructure.ssd", structure())
        archive.writestr("resources/start.ssv", parameters())
        for name in COMPONENTS.values():
            archive.write(Path(fmus) / name, f"resources/{name}")


if __name__ == "__main__":
    main(*sys.argv[1:])
