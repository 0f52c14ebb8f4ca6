"""Where a camera sees points and spheres: written for the tests, from the camera's place and angle alone"""

import numpy as np


class Camera:
    """`about`: position, target, up, angle [deg] from lower to upper edge, width and height in pixels"""

    def __init__(self, about):
        self.position = np.array(about["position"])
        forward = np.array(about["target"]) - self.position
        self.forward = forward / np.linalg.norm(forward)
        right = np.cross(self.forward, about["up"])
        self.right = right / np.linalg.norm(right)
        self.up = np.cross(self.right, self.forward)
        self.width, self.height = about["width"], about["height"]
        self.focus = 0.5 * self.height / np.tan(0.5 * np.radians(about["angle"]))

    def project(self, points):
        """Returns pixels from the left and from the top of the picture, one row a point."""
        apart = np.atleast_2d(points) - self.position
        depth = apart @ self.forward
        x = 0.5 * self.width + self.focus * (apart @ self.right) / depth
        y = 0.5 * self.height - self.focus * (apart @ self.up) / depth
        return np.column_stack([x, y])

    def disc(self, center, radius):
        """Returns middle and area of a sphere's picture: an ellipse, hardly shifted against the centre."""
        apart = center - self.position
        distance = np.linalg.norm(apart)
        toward = apart / distance
        side = np.cross(toward, self.up)
        side = side / np.linalg.norm(side)
        # The rays that touch the sphere do so on a circle somewhat nearer than its centre.
        share = (radius / distance) ** 2
        angle = np.linspace(0.0, 2.0 * np.pi, 2001)[:-1, None]
        around = np.cos(angle) * side + np.sin(angle) * np.cross(toward, side)
        outline = self.project(center - share * apart + radius * np.sqrt(1.0 - share) * around)
        x, y = (outline - outline[0]).T
        cross = x * np.roll(y, -1) - np.roll(x, -1) * y
        area = 0.5 * np.sum(cross)
        middle = [np.sum((one + np.roll(one, -1)) * cross) / (6.0 * area) for one in (x, y)]
        return outline[0] + middle, abs(area)
