"""The same systems with ptmcad and with programs that do a part of the work: time, memory, and what they leave to do.

Guarantee: each program is a process of its own that gets the same mathematical question as the others that can answer
it, and what it answers is held against ptmcad's map wherever both say something.

- `programs`: how each program is asked, whether it has answered, and how its answer is read;
- `questions`: the texts of the questions, made of ptmcad's curves and equations in a process of their own;
- `agreement`: the answers against the map, in that process too;
- `measuring`: the runs;
- `table`: the page.
"""
