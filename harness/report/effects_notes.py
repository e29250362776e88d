"""What stands above the tables of the effects report."""

NOTES = {
    "effects": (
        "An effect is on because a table of the scene says so, and only then. Every one is switched alone; what "
        "comes (+) or goes (-) with it is told. Numbers of effects that the scene does not have follow from its "
        "own."
    ),
    "smallest": (
        "An effect may go when without it every chosen quantity is shown to stay within the tolerance. All that "
        "may go are then left out together, and a run of that scene decides. Times: of a whole run, over the scene "
        "as declared."
    ),
    "trials": (
        "Combinations that were run, on the same packings."
    ),
    "chosen": (
        "Change: mean over packings of the switched scene less the scene as declared on the same packing, over its "
        "size. Error bar: spread over packings of the scene as declared, of one packing the standard error of its "
        "time average, of what bodies leave a free scene with the tolerance. Within the tolerance: shown to be "
        "(agrees), shown not to be (differs), or neither (inconclusive), each at 5 %."
    ),
    "costs": (
        "CPU time of a step in sessions that stay open side by side and make stretches of steps in turn; set-up "
        "and output are outside. Ratios are taken stretch by stretch: median, least, largest. A whole run also has "
        "other steps where the law asks for them. Few bodies are timed many times side by side."
    ),
    "traces": (
        "What an engine's deck, the kernel's program (operations a step), the memory of a contact and the output "
        "have more with the effect than without it, and what stands there while it is off. Agrees: nothing. A "
        "known difference: what an engine cannot leave out, with the reason."
    ),
    "zeros": (
        "Runs that start together, with the effect off, and on with its coefficient at zero: largest difference of "
        "displacement and velocity over their size. Off from on shows that the effect does something in these "
        "steps. What the scene's rules refuse (a friction of 0) is given to the engine past them. Not checked is "
        "no pass."
    ),
    "changes": (
        "Every quantity that the runs have."
    ),
}
