"""Radiosity with one patch a surface: the classical matrix method on exact form factors."""

# Gauss and Seidel's error falls by the reflectance in each sweep: 0.99 to this power is below rounding.
SWEEPS = 4000


def radiosities(names, factor, exitance, reflectance):
    """B = E + rho F B by Gauss-Seidel. `factor` is {(from, to): F}; the others are by name."""
    rows = {a: [(b, factor[a, b]) for b in names if factor.get((a, b), 0) > 0] for a in names}
    radiosity, change = dict(exitance), 1.0
    for _ in range(SWEEPS):
        change = 0.0
        for a in names:
            value = exitance[a] + reflectance[a] * sum(f * radiosity[b] for b, f in rows[a])
            change, radiosity[a] = max(change, abs(value - radiosity[a])), value
        if change <= 1e-15 * max(radiosity.values()):
            break
    return radiosity


def script_factors(factors, reflectance):
    """Hottel's script-F of grey surfaces: what i emits and j absorbs, interreflections included.

    e_i (I - F R)^-1 F e_j, one column at a time by Gauss and Seidel."""
    count, columns = len(factors), []
    for j in range(count):
        absorbed = [factors[i][j] * (1 - reflectance[j]) for i in range(count)]
        reached = list(absorbed)
        for _ in range(SWEEPS):
            change = 0.0
            for i in range(count):
                value = absorbed[i] + sum(f * r * x for f, r, x in zip(factors[i], reflectance, reached))
                change, reached[i] = max(change, abs(value - reached[i])), value
            if change <= 1e-16:
                break
        columns.append(reached)
    return [[(1 - reflectance[i]) * columns[j][i] for j in range(count)] for i in range(count)]


def _solve(program, case):
    """The exact form factors of a case, by name, and the seconds."""
    model = {"id": case["id"], "surfaces": case["surfaces"]}
    return program.form_factors(model, "--method", "exact", "--tolerance", 1e-6)


def rooms(program, case, table):
    """Patch radiosities of a room, relative."""
    factor, seconds = _solve(program, case)
    names, worst = [s["name"] for s in case["surfaces"]], 0
    for k in range(3):
        found = radiosities(names, factor, {s["name"]: s["emit"][k] for s in case["surfaces"]},
                            {s["name"]: s["rho"][k] for s in case["surfaces"]})
        for e in case["expect"]:
            worst = max(worst, abs(found[e["surface"]] / e["value"][k] - 1))
    table.add(case["id"], "matrix", worst, seconds=seconds, note="relative")


def _grouped(case, areas, factor):
    """Form factors between groups of surfaces, each of one temperature, by the groups' names."""
    groups = {"+".join(g): g for g in case["groups"]}
    return groups, {(a, b): sum(areas[i] * factor.get((i, j), 0) for i in of for j in to) / sum(areas[i] for i in of)
                    for a, of in groups.items() for b, to in groups.items()}


def heat(program, case, areas, table):
    """Grey bodies: exitance is emissivity times sigma T^4; a wall gives off B - H, told of the largest."""
    factor, seconds = _solve(program, case)
    groups, merged = _grouped(case, areas, factor)
    paint = {s["name"]: s for s in case["surfaces"]}
    exitance = {name: paint[g[0]]["emit"][0] for name, g in groups.items()}
    found = radiosities(list(groups), merged, exitance, {name: paint[g[0]]["rho"][0] for name, g in groups.items()})
    largest = max(abs(e["value"][0]) for e in case["expect"])
    worst, printed = 0, 0
    for e in case["expect"]:
        b, irradiance = found[e["surface"]], sum(merged[e["surface"], n] * found[n] for n in groups)
        worst = max(worst, abs(b - irradiance - e["value"][0]) / largest)
        order = list(groups).index(e["surface"])
        printed = max(printed, abs(irradiance - b - case["published"]["value"][order]) / largest)
    table.add(case["id"], "matrix", worst, seconds=seconds, note="net flux, of the largest",
              published=f"ViewHT, four digits printed: {printed:.1e} from ours")
