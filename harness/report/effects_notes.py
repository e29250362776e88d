"""What stands above the tables of the effects report."""

NOTES = {
    "effects": (
        "An effect is on because a table of the scene says so, and only then. Every one is switched alone; what "
        "comes (+) or goes (-) with it is told. Numbers of effects that the scene does not have follow from its "
        "own."
    ),
    "smallest": (
        "An effect goes when without it every chosen quantity is shown to stay within the tolerance, and time is "
        "saved beyond what the timing scatters by: on one engine at least the whole range of the ratio lies below 1, "
        "and the mean over engines does (a ratio whose range holds 1 counts as 1). All that may go are then left out "
        "together, and a run of that scene decides. Times: of a whole run, over the scene as declared."
    ),
    "trials": (
        "Combinations that were run, on the same packings: the chosen quantities, and all others that differ (the "
        "CSV table has every one)."
    ),
    "chosen": (
        "Change: mean over packings of the switched scene less the scene as declared on the same packing, over what "
        "its column names. exit (velocity, and spin times radius, that bodies leave with), velocity, spin and "
        "stress_strain are deviations from the scene as declared, as parts of that (unit 1): as declared they are "
        "0, without an error bar. Error bar: of the scene as declared, what one packing tells: the standard "
        "deviation over packings, of a single packing the standard error of its time average. Standard error: of "
        "the change. Within the tolerance: shown to be (agrees), shown not to be (differs), or neither "
        "(inconclusive), each at 5 %. Packings needed: so many would be expected to tell, in four of five cases, if "
        "the change is as measured."
    ),
    "costs": (
        "CPU time of a step in sessions that stay open side by side and make stretches of steps in turn; set-up "
        "and output are outside. Ratios are taken stretch by stretch: median, least, largest. A whole run also has "
        "other steps where the law asks for them. Few bodies are timed many times side by side."
    ),
    "traces": (
        "What an engine's deck, the kernel's program (operations a step), the memory of a contact and the output "
        "have more with the effect than without it, and what stands there while it is off. Agrees: nothing. A "
        "known difference: what an engine cannot leave out, with the reason. Lines are shortened here; traces.csv "
        "has all of them in full."
    ),
    "zeros": (
        "Runs that start together, with the effect off, and on with its coefficient at zero, or at 1e-30 of itself "
        "where 0 is how the scene says off: largest difference of displacement and velocity over their size. Off "
        "from on shows that the effect does something in these steps. What the scene's rules refuse (a friction of "
        "0) is given to the engine past them. Not checked is no pass."
    ),
    "changes": (
        "Every quantity that the runs have."
    ),
}
