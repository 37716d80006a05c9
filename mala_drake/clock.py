"""The one clock: every period and phase offset of the diagram, in seconds.

Two time scales (paper, Fig. integration_timescales): the slow one advances by planned actions, the fast one by the
control period `TICK`. Events of one kind at the same instant see each other's *old* values, so each layer of the chain
sense -> ground -> plan -> execute -> control acts a little after the one it listens to, within the same tick. Layers
that need not hear each other within a tick share a moment: every moment costs time, whatever happens then.
"""

from __future__ import annotations

PLANT_STEP = 0.02
"""Period of the discrete plant, the drivetrain, the battery and the safety monitor.

With a step eight times shorter the features of an episode differ by less than 0.01 (a slow test of the station).
"""

TICK = 0.2
"""Control period h of the fast time scale; the planner and the scheduler look at the world once a tick."""

SENSE_OFFSET = 0.0005
"""Just after the plant's step: multiples of a tick and of the plant's step differ in the last bit, so that without it
the estimator would now and then sample before the step of the same instant instead of after it."""

WORLD_OFFSET = SCHEDULE_OFFSET = SENSE_OFFSET
"""The world looks at the plant's own state, the scheduler at the planner's last report, and neither at the other's news
of the same tick."""

PLAN_OFFSET = 0.003
EXECUTE_OFFSET = 0.004
CONTROL_OFFSET = 0.005
METER_OFFSET = 0.006
PATIENT_OFFSET = LEARN_OFFSET = 0.007
"""Who learns from the patient hears him all the same: that update is discrete, his is unrestricted, and at one instant
the unrestricted updates come first."""

ROUNDING = 1e-6
"""Slack for comparing simulation times, which are sums of ticks."""
