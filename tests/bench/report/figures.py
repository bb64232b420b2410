"""The figures: what each one says, what is aimed at, and how it is drawn. Only this table knows them;
a program whose figure is not here is shown all the same, in plain tables."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Goal:
    """One number to reach."""

    quantity: str
    limit: float
    peer: str = ""  # ours over this peer's; "": the value itself
    at_least: bool = False
    case: str = None  # None: in every case
    subject: str = "gyrotwin"
    why: str = ""  # where the number is from, when that is not obvious

    def holds(self, value):
        return value >= self.limit if self.at_least else value <= self.limit


@dataclass(frozen=True)
class Ratios:
    """Bars of ours over each peer's, on a logarithmic axis."""

    quantities: tuple
    subjects: tuple = ("gyrotwin",)
    beside_peers: bool = True  # the first quantity is in the page's first plot too


@dataclass(frozen=True)
class Distribution:
    """From p50 to p99, and a thin line to the largest, for every subject."""


@dataclass(frozen=True)
class Precision:
    """Error over time, one plot a case: who stands to the lower left is better."""

    error: str
    time: str


@dataclass(frozen=True)
class Growth:
    """A quantity over the case, which is a number."""

    quantity: str
    across: str  # what the case counts
    reference: str = ""  # "proportional": through the first point and the origin; "flat"


@dataclass(frozen=True)
class Bars:
    """A quantity, a bar for every case and subject, from zero."""

    quantity: str


@dataclass(frozen=True)
class Figure:
    name: str
    title: str
    what: str  # what is measured, and how: for who looks at the page
    goals: tuple = ()
    plots: tuple = ()
    words: dict = field(default_factory=dict)  # quantity: what it is called
    percent: tuple = ()  # quantities that are told in percent


_MIDDLEWARE = ("ZeroMQ", "ZeroMQ ipc", "Cyclone DDS")

FIGURES = (
    Figure(
        "round_trip", "Round trip: state out, command back",
        "Two processes, SCHED_FIFO: one sends a STATE of about 300 bytes, the other answers with a "
        "COMMAND. From before the first send to after the last receive, both on one core, or "
        "each on its own.",
        goals=(Goal("p50", 1.25, "raw UDP", case="one_core"),
               Goal("p50", 0.45, "liblcm", case="one_core"),
               Goal("p99", 1, "liblcm", case="one_core"),
               *(Goal("p50", 1, name, case="one_core", why="ahead of every middleware")
                 for name in _MIDDLEWARE)),
        plots=(Ratios(("p50", "p99"), ("gyrotwin", "gyrotwin signed")), Distribution()),
        words={"system_calls": "system calls a round trip",
               "context_switches": "context switches a round trip"}),
    Figure(
        "loop", "The closed loop of one rig, through the daemons",
        "From the tick that publishes a STATE to the command that acts: integrator and controller "
        "as they are shipped.",
        plots=(Distribution(),),
        words={"in_time": "commands in time"}, percent=("in_time",)),
    Figure(
        "wakeup", "Waking up on time",
        "How late a 1 kHz loop at priority 80 wakes up, beside cyclictest with the same period, "
        "priority, locked memory and, as daemons leave them on, sleep states of the processors "
        "(`--laptop`), in turns of half a second.",
        goals=(Goal("p50", 1.05, "cyclictest"), Goal("p99", 1.05, "cyclictest"),
               Goal("p50", 1.0, subject="gyrotwin hybrid", why="sleeps, then spins")),
        plots=(Distribution(), Ratios(("p50", "p99"), ("gyrotwin", "gyrotwin hybrid")))),
    Figure(
        "acceleration", "Acceleration of the whole machine",
        "Mass matrix, forces, contacts and the solution, for one state. The peers have the same "
        "mechanism from the same rig file, and agree with us before the clock runs; `projected` is "
        "an engine's tree with the gears projected by us, where that is faster than its own.",
        goals=(Goal("p50", 1 / 20, "MuJoCo", why="mj_forward, as the engine solves it"),
               Goal("p50", 1 / 20, "MuJoCo projected", why="the engine's tree, our gears")),
        plots=(Ratios(("p50",)), Distribution()),
        words={"disagreement": "disagreement, relative", "instructions": "instructions (callgrind)"}),
    Figure(
        "arithmetic", "Distance from the floor of the arithmetic",
        "Time of an acceleration over the time that its counted multiplications, additions, "
        "divisions and square roots take by themselves.",
        goals=(Goal("p50", 2, "floor"),),
        plots=(Ratios(("p50",), beside_peers=False),)),
    Figure(
        "tick", "One tick",
        "The physics of the rig's tick, 1 ms or 2 (`double_brennan`), law's torques held: our shipped "
        "steps beside MuJoCo's Runge-Kutta 4. Each is compared with its own solution at the finest "
        "steps, over the same scenario.",
        goals=(Goal("p50", 1, "MuJoCo"), Goal("error", 0.01, "MuJoCo")),
        plots=(Precision("error", "p50"), Ratios(("p50",)), Distribution()),
        words={"error": "off by"}),
    Figure(
        "rigs", "Closed loops in real time on this machine",
        "So many rigs at once, each with an integrator and a controller of its own at 1 kHz, all "
        "signed. Held: none stopped safely, and at most 0.5 % of the ticks were skipped beyond what "
        "the machine's hypervisor kept from a loop meanwhile, in one of two tries. The count goes up "
        "until two in a row are not held.",
        goals=(Goal("held", 15, at_least=True, case=""),
               Goal("cost_growth", 1.25, case="", why="cost is linear in rigs")),
        plots=(Growth("cpu", "rigs", "proportional"), Growth("skipped", "rigs"),
               Growth("late_p99", "rigs")),
        words={"held": "rigs held", "cpu": "CPUs used", "skipped": "ticks skipped",
               "withheld": "withheld by the machine", "stopped": "rigs that stopped safely",
               "late_p99": "lateness p99, the middle rig",
               "cost_growth": "CPU per rig, most over fewest rigs"},
        percent=("skipped", "withheld")),
    Figure(
        "listeners", "What listeners cost the owner",
        "CPU time of the integrator while so many `gyrotwin top` listen to it, beside its "
        "controller. The kernel delivers to each in the sender's name.",
        goals=(Goal("cost_growth", 1.5, case="", why="nearly flat: eight listeners over none"),),
        plots=(Growth("cpu", "listeners", "flat"), Growth("late_p99", "listeners")),
        words={"cpu": "CPUs of the integrator", "late_p99": "lateness p99",
               "cost_growth": "CPU with most over without listeners"}),
    Figure(
        "highest_rate", "The highest rate of one loop",
        "Integrator and controller as processes, signed; the rate of prototype_b goes up to the "
        "10 kHz that a rig file may ask for.",
        plots=(Growth("cpu", "Hz", "proportional"), Growth("late_p99", "Hz")),
        words={"held": "rate held", "cpu": "CPUs used", "skipped": "ticks skipped",
               "withheld": "withheld by the machine", "late_p99": "lateness p99"},
        percent=("skipped", "withheld")),
    Figure(
        "gyros", "A tick against the machine",
        "CPU time of a simulated tick of 1 ms with four steps, law included, no network.",
        plots=(Bars("cpu"),), words={"cpu": "a tick of 1 ms"}),
    Figure(
        "substeps", "A tick against the steps in it",
        "prototype_b: CPU time of a simulated tick of 1 ms, law included, no network.",
        plots=(Growth("cpu", "steps a tick", "proportional"),), words={"cpu": "a tick of 1 ms"}),
    Figure(
        "sweep", "Trajectories in sweeps",
        "`gyrotwin sweep` of 40 closed-loop runs by one worker and by two. Simulated time over "
        "CPU time; off is the largest error of a coordinate in 5 s from the farthest start, "
        "against steps of 1e-12. Efficiency is the mean wall time of two sweeps side by side, half of "
        "the runs and one worker each, over that of one sweep with two workers: what a core loses "
        "when the other one works too is in both. Beside it, how much faster two are than one.",
        goals=(Goal("times_real_time", 300, at_least=True, case="prototype_b"),
               Goal("times_real_time", 2000, at_least=True, case="double_brennan"),
               Goal("times_real_time", 2000, at_least=True, case="brennan_monorail"),
               Goal("off", 1e-6), Goal("efficiency", 0.95, at_least=True),
               Goal("identical", 1, at_least=True)),
        plots=(Bars("times_real_time"), Bars("efficiency")),
        words={"times_real_time": "times real time, one core", "efficiency": "efficiency of two",
               "faster": "times faster by two than by one",
               "identical": "same bytes by one and by two (1: yes)",
               "off": "off by", "of_fixed": "times a live system's steps"}),
    Figure(
        "logger", "Recording a flood",
        "The same signed messages of 304 bytes, in bursts a millisecond apart, recorded by "
        "`gyrotwin log record` and by lcm-logger in turns; lost is what is not in the file.",
        goals=(Goal("lost", 0, case="20000"),),
        plots=(Growth("lost", "messages a second"),),
        words={"lost": "messages lost", "rate": "messages sent a second"}, percent=("lost",)),
    Figure(
        "mirror", "A step of the mirror",
        "The twin takes one set of sensors: unscented Kalman filter and health.",
        goals=(Goal("p50", 300),),
        plots=(Bars("p50"),), words={"p50": "median", "p90": "90 % are below"}),
    Figure(
        "start", "From deploy/run to a balancing rig and its page",
        "Everything is built already. Until prototype_b balances and its page is answered.",
        goals=(Goal("page_open", 5, case=""),),
        plots=(Bars("page_open"),), words={"page_open": "balanced, page open"}),
)

BY_NAME = {figure.name: figure for figure in FIGURES}


def figure_of(name):
    """The figure, or a plain one for a name that the table does not have."""
    return BY_NAME.get(name, Figure(name, name.replace("_", " ").capitalize(), ""))
