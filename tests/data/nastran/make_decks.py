"""Writes the decks of this folder: python3 make_decks.py

Each deck is of a kind that users have; sizes and figures are explained in README.md.
"""

import math


def write(name, lines):
    with open(name, "w") as file:
        file.write("\n".join(lines) + "\n")


def real(value):
    """A real in eight columns, as many digits as fit."""
    if value == 0.0:
        return "0."
    for digits in range(7, 0, -1):
        mantissa, exponent = f"{value:.{digits}e}".split("e")
        short = f"{mantissa}{int(exponent):+d}"
        plain = repr(round(value, max(0, digits - 1 - math.floor(math.log10(abs(value))))))
        for text in (plain, short):
            text = text.replace("0.", ".", 1) if text.startswith("0.") else text
            if len(text) <= 8 and "." in text and "e" not in text:
                return text
    raise ValueError(value)


def card(name, *fields):
    """A small-field entry with blank continuations."""
    text = [real(f) if isinstance(f, float) else str(f) for f in fields]
    lines = []
    for start in range(0, len(text), 8):
        head = name if start == 0 else ""
        lines.append("".join(f"{f:<8}" for f in [head] + text[start : start + 8]).rstrip())
    return lines


def large(name, *fields):
    """A large-field entry: sixteen columns."""
    text = [f"{f:.9e}".replace("e", "E") if isinstance(f, float) else str(f) for f in fields]
    lines = []
    for start in range(0, len(text), 4):
        head = name + "*" if start == 0 else "*"
        lines.append((f"{head:<8}" + "".join(f"{f:<16}" for f in text[start : start + 4])).rstrip())
    return lines


def section():
    """Pitch and plunge section of strip theory, SI units: a -0.2, x 0.1, r2 0.24, mu 20, omega_h/omega_a 0.4, b 0.5 m."""
    b, rho, mu, a, x, r2, ratio, omega = 0.5, 1.2, 20.0, -0.2, 0.1, 0.24, 0.4, 20.0
    mass = mu * math.pi * rho * b * b
    inertia, static = mass * r2 * b * b, mass * x * b
    stiff_h, stiff_a = mass * (ratio * omega) ** 2, inertia * omega**2
    axis = b * (1.0 + a)
    lines = [
        "ID SECTION,STRIP",
        "SOL 145 $ flutter",
        "CEND",
        "TITLE = PITCH AND PLUNGE SECTION, STRIP THEORY",
        "METHOD = 1",
        "DISP = ALL",
        "SUBCASE 1",
        "  LABEL = PK METHOD",
        "  FMETHOD = 10",
        "SUBCASE 2",
        "  LABEL = K METHOD",
        "  FMETHOD = 20",
        "OUTPUT(XYOUT)",
        "  XTITLE = VELOCITY",
        "  XYPLOT VG / 1(G,F) 2(G,F)",
        "BEGIN BULK",
        "$ elastic axis at 40 percent of the chord of 1 m, span 1 m",
    ]
    lines += card("GRID", 1, "", 0.0, 0.5, 0.0, "", 1246)
    lines += card("GRID", 2, "", 0.0, 1.0, 0.0)
    lines += card("RBAR", 3, 1, 2, 123456)
    lines += large("CELAS2", 11, stiff_h, 1, 3)
    lines += large("CELAS2", 12, stiff_a, 1, 5)
    # Displacement up and rotation nose up: a mass behind the axis has a negative coupling with rotation about y.
    blanks = [""] * 5
    lines += large("CONM1", 21, 1, "", *blanks, mass, *[""] * 6, -static, "", inertia)
    lines += card("AERO", 0, "", 1.0, rho, 0, 0)
    lines += card("CAERO4", 1000, 1000, "", 1, "", "", "", "", -axis, 0.0, 0.0, 1.0, -axis, 1.0, 0.0, 1.0)
    lines += card("PAERO4", 1000, 0, 0, 0, 0, 0.0, 0.0, 0.0)
    lines += card("SET1", 1100, 1, 2)
    lines += card("SPLINE2", 1200, 1000, 1000, 1000, 1100, 0.0, 1.0, 0, 0.0, 0.0)
    lines += card("MKAERO1", 0.0, *[""] * 7, 0.02, 0.05, 0.08, 0.11, 0.14, 0.17, 0.2, 0.24)
    lines += card("MKAERO1", 0.0, *[""] * 7, 0.26, 0.28, 0.3, 0.32, 0.34, 0.38, 0.44, 0.5)
    lines += card("MKAERO1", 0.0, *[""] * 7, 0.6, 0.8, 1.0, 1.3, 1.7, 2.5, 4.0, 8.0)
    lines += card("EIGR", 1, "MGIV", 0.0, 25.0, "", 2, "", "", "MAX")
    lines += card("FLUTTER", 10, "PK", 1, 2, 3, "L", 2)
    lines += card("FLUTTER", 20, "K", 1, 2, 4, "L", 2)
    lines += card("FLFACT", 1, 1.0)
    lines += card("FLFACT", 2, 0.0)
    lines += card("FLFACT", 3, 4.0, "THRU", 30.0, 27)
    lines += card("FLFACT", 4, 0.5, 0.45, 0.4, 0.36, 0.33, 0.31, 0.29, 0.27, 0.25, 0.22)
    lines.append("ENDDATA")
    write("section_strip.bdf", lines)


def swept_plate():
    """Plate wing swept by 15 degrees with bevelled edges; the geometry of model A of NASA TN D-1824."""
    chord, step, slope = 2.07055, 0.7893, math.tan(math.radians(15.0))
    parts = [0.0, 0.125, 0.5, 0.875, 1.0]
    lines = [
        "ID PLATE,SWEPT",
        "TIME 5",
        "SOL 145",
        "CEND",
        "TITLE = 15-DEGREE SWEPT PLATE WING, 28 QUADRILATERALS",
        "SUBT = DOUBLET LATTICE, MACH 0.45",
        "ECHO = NONE",
        "SPC = 1",
        "SDAMP = 2000",
        "METHOD = 10",
        "SVEC(PLOT) = ALL",
        "SUBCASE 1",
        "  FMETHOD = 30",
        "SUBCASE 2",
        "  FMETHOD = 40",
        "BEGIN BULK",
        "$ lbf, in, s; five by eight grid points",
    ]
    for i, part in enumerate(parts):
        for j in range(8):
            y = step * j
            lines += card("GRID", 8 * i + j + 1, "", part * chord + slope * y, y, 0.0)
    for i in range(4):
        for j in range(7):
            first = 8 * i + j + 1
            corners = [first, first + 1, first + 9, first + 8]
            number = 7 * i + j + 1
            edge = {0: [0.0, 0.0, 0.041, 0.041], 3: [0.041, 0.041, 0.0, 0.0]}.get(i)
            lines += card("CQUAD4", number, 1, *corners, *((["", "", "", ""] + edge) if edge else []))
    lines += card("PSHELL", 1, 1, 0.041, 1, "", 1)
    lines.append("MAT1    1       9.2418+63.4993+6        .097464")
    lines += ["PARAM   COUPMASS1", "PARAM   WTMASS  .0025901", "PARAM   VREF    12.", "PARAM   KDAMP   1"]
    lines += card("SPC1", 1, 12345, 9) + card("SPC1", 1, 12345, 25) + card("SPC1", 1, 6, 1, "THRU", 40)
    lines += card("ASET1", 3, 1, "THRU", 8) + card("ASET1", 3, 10, "THRU", 16) + card("ASET1", 3, 18, "THRU", 24) + card("ASET1", 3, 26, "THRU", 40)
    lines += card("TABDMP1", 2000, *[""] * 7, 0.0, 0.0, 1000.0, 0.0, "ENDT")
    lines += card("AERO", 0, "", 2.0706, 1.1092e-7, 1)
    tip = 7 * step
    lines += card("CAERO1", 101, 1, 0, 6, 4, "", "", 1, 0.0, 0.0, 0.0, chord, round(slope * tip, 5), tip, 0.0, chord)
    lines += card("PAERO1", 1)
    points = [2, 4, 6, 8, 9, 11, 13, 15, 18, 20, 22, 24, 25, 27, 29, 31, 34, 36, 38, 40]
    lines += card("SET1", 100, *points)
    lines += card("SPLINE1", 100, 101, 101, 124, 100, 0.0)
    lines += card("EIGR", 10, "MGIV", "", "", "", 4, "", "", "MAX")
    lines += card("MKAERO1", 0.45, *[""] * 7, 0.001, 0.05, 0.1, 0.12, 0.14, 0.16, 0.2, 0.25)
    lines += card("MKAERO2", 0.45, 0.5, 0.45, 1.2)
    lines += card("FLUTTER", 30, "PK", 1, 2, 4, "L", 4)
    lines += card("FLUTTER", 40, "K", 1, 2, 3, "L", 4)
    lines += card("FLFACT", 1, 0.967) + card("FLFACT", 2, 0.45)
    lines += card("FLFACT", 3, 0.2, 0.16667, 0.14286, 0.125, 0.1111, 0.1)
    lines += card("FLFACT", 4, 4000.0, 4600.0, 5200.0, 5600.0, 5800.0, 6000.0, 6400.0)
    lines += card("PARAM", "LMODES", 4)
    lines.append("ENDDATA")
    write("swept_plate.bdf", lines)


def jet_wing():
    """A tapered wing on a flexible axis as a GENEL and as CBARs, with dumb-bell masses; SI units."""
    stations = [3.0, 6.0, 9.0, 12.0, 14.5]
    bending, torsion = 2.0e7, 1.5e7
    masses = [(1800.0, 3.0), (1500.0, 2.6), (1100.0, 2.2), (700.0, 1.8), (300.0, 1.5)]
    head = [
        "ID WING,JET",
        "SOL 145",
        "CEND",
        "TITLE = JET TRANSPORT WING, {kind}",
        "SPC = 1",
        "METHOD = 10",
        "FMETHOD = 40",
        "BEGIN BULK",
    ]
    common = []
    for i, y in enumerate(stations):
        common += card("GRID", i + 1, "", 0.0, y, 0.0)
    for i, (mass, arm) in enumerate(masses):
        # Half of the mass at either end of a rigid dumb-bell across the axis, its centre 0.15 m behind it.
        common += card("CONM2", 100 + i, i + 1, "", mass, 0.15, 0.0, 0.0, "", 0.0, "", 0.25 * mass * arm * arm)
    common += card("GRID", 11, "", 0.0, 0.0, 0.0)
    common += card("SPC1", 1, 123456, 11) + card("SPC1", 1, 126, *range(1, 6))
    common += card("AERO", 5, "", 4.0, 1.225, 1)
    # An aerodynamic system whose origin lies on the axis, and panels of unequal divisions that begin at the root.
    common += card("CORD2R", 5, "", -0.4, 0.0, 0.0, -0.4, 0.0, 1.0, 0.6, 0.0, 0.0)
    common += card("CAERO1", 1001, 1000, 5, "", "", 77, 78, 1, -1.5, 0.0, 0.0, 5.6, -0.4, 15.0, 0.0, 2.4)
    common += card("PAERO1", 1000)
    common += card("AEFACT", 77, 0.0, 0.12, 0.26, 0.4, 0.54, 0.67, 0.79, 0.9, 1.0)
    common += card("AEFACT", 78, 0.0, 0.2, 0.45, 0.7, 1.0)
    common += card("SET1", 14, 1, "THRU", 11)
    common += card("SPLINE2", 16, 1001, 1001, 1032, 14, 0.0, 1.0, 0, 0.0, 0.0)
    common += card("EIGRL", 10, "", "", 8)
    common += card("MKAERO1", 0.0, *[""] * 7, 0.001, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0)
    common += card("FLUTTER", 40, "PK", 1, 2, 4, "L", 5)
    common += card("FLFACT", 1, 1.0) + card("FLFACT", 2, 0.0)
    common += card("FLFACT", 4, 60.0, 100.0, 140.0, 180.0, 220.0, 260.0, -300.0, 340.0, 380.0)
    common += card("PARAM", "LMODES", 6)
    tail = ["ENDDATA"]
    elastic = []
    flexibility = {}
    for i, y in enumerate(stations):
        elastic += [(i + 1, 3, y), (i + 1, 4, y), (i + 1, 5, y)]
    for p, (_, cp, yp) in enumerate(elastic):
        for q, (_, cq, yq) in enumerate(elastic):
            low, high = min(yp, yq), max(yp, yq)
            if cp == cq == 3:
                value = low * low * (3.0 * high - low) / (6.0 * bending)
            elif cp == cq == 4:
                value = low / bending
            elif cp == cq == 5:
                value = low / torsion
            elif {cp, cq} == {3, 4}:
                # Slope dw/dy at the rotation's station from a unit force at the displacement's.
                at, load = (yp, yq) if cp == 4 else (yq, yp)
                value = at * (load - 0.5 * at) / bending if at <= load else 0.5 * load * load / bending
            else:
                value = 0.0
            flexibility[p, q] = value
    fields = [432, ""]
    for grid, component, _ in elastic:
        fields += [grid, component]
    fields += [""] * (-len(fields) % 8)
    fields += ["UD", ""]
    for component in (3, 4, 5):
        fields += [11, component]
    fields += [""] * (-len(fields) % 8)
    fields += ["Z"] + [flexibility[p, q] for q in range(len(elastic)) for p in range(q, len(elastic))]
    fields += [""] * (-len(fields) % 8)
    fields += ["S"]
    for _, component, y in elastic:
        fields += {3: [1.0, y, 0.0], 4: [0.0, 1.0, 0.0], 5: [0.0, 0.0, 1.0]}[component]
    genel = large("GENEL", *fields)
    write("jet_wing_genel.bdf", [l.format(kind="GENEL") for l in head] + genel + common + tail)
    bars = []
    previous = 11
    for i in range(5):
        bars += card("CBAR", i + 1, 9, previous, i + 1, 0.0, 0.0, 1.0)
        previous = i + 1
    bars += large("PBAR", 9, 9, 1.0, bending / 1.0e9, bending / 1.0e9, torsion / 4.0e8)
    bars += ["MAT1    9       1.+9    4.+8"]
    write("jet_wing_bars.bdf", [l.format(kind="CBAR") for l in head] + bars + common + tail)


section()
swept_plate()
jet_wing()
