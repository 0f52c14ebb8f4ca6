"""Reads the rows of a sweep with pandas: the coefficient of restitution over the damping ratio.

contact-fmus sweep examples/sweep/restitution.toml
.venv/bin/python examples/sweep/read_results.py results/restitution/results.parquet
"""

import sys

import pandas

PENALTY, MASS, SPEED = 1e5, 1.0, 1.0  # of the study [N/m, kg, m/s]


def main(path):
    rows = pandas.read_parquet(path)
    rows = rows[rows["status"] == "ok"]  # runs that failed are rows too
    damping_ratio = rows["contact.viscous_penalty_factor"] / (2.0 * (PENALTY * MASS) ** 0.5)
    rows = rows.assign(damping_ratio=damping_ratio.round(4), restitution=rows["speed_after"] / SPEED)
    table = rows.pivot(index="damping_ratio", columns="contact.dashpot", values="restitution")
    print(table.to_string(float_format="{:.6f}".format))


if __name__ == "__main__":
    main(sys.argv[1])
