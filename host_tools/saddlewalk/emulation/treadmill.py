"""A treadmill under the emulated wearer, whose belt keeps the speed that is commanded."""


class Treadmill:
    """Both feet are on one belt. What sensors in the room measure lacks the belt's speed."""

    def __init__(self, acceleration_m_s2: float) -> None:
        self.belt_m_s = 0.0  # along x: negative as it runs backward
        self._acceleration_m_s2 = acceleration_m_s2

    def run(self, walking_m_s: float, for_s: float) -> None:
        """Let the belt carry who walks at that speed, as soon as its motor can."""
        most_m_s = self._acceleration_m_s2 * for_s
        missing_m_s = -walking_m_s - self.belt_m_s
        self.belt_m_s += min(max(missing_m_s, -most_m_s), most_m_s)
