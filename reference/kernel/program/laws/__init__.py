"""One file a law: its formula, and the operations that compute it in place.

What they find in `Contacts`: overlap (0 where nothing touches), u = v_n + i v_t (0 there), normal. What they leave:
f_n, and in g = f_n + i f_t the tangential force on i along t = i n. Work arrays a, b are free at the start of a law.
"""
