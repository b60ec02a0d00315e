# The same maps for the theory with memory (theory/memory.md).
title_text = "S1 ideal gas: deviation from the theory with memory in %"
forms = "memory-kinetic memory-collision memory-D"
load directory."/plot.gp"
