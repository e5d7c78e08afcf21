"""The page's solver written once more, with numpy and from what the page carries alone."""

import base64
from types import SimpleNamespace

import numpy as np
from scipy.optimize import minimize_scalar


def numbers(text, kind="<f4"):
    return np.frombuffer(base64.b64decode(text), dtype=kind).astype(float)


class Solver:
    """`fit({key, ...})` answers as the page does; a key is EFFECT:PLACE, or EFFECT for an effect of the robot."""

    def __init__(self, data):
        self.data, self.own, self.count = data, data["own"], data["columns"]
        self.reference = numbers(data["reference"], "<f8")
        motors = data["motors"]
        self.n, self.rows, self.free = len(motors), data["rows"], data["fits_gains"]
        self.gains0 = np.array([one["gain"] for one in motors])
        self.nominal = np.array([one["nominal"] for one in motors])
        self.grams = {use: [self._gram(one, use) for one in motors] for use in ("fitted", "judged")}
        self.moving = np.array([one["fitted"]["moving"] for one in motors])
        self.squares = {
            use: np.array([one[use]["squares"] for one in motors]) for use in ("fitted", "judged")
        }
        self.dependent = 4e-10 if data["basis"] is None else 1e-7
        self.places = {}
        for effect in data["effects"]:
            for place in effect["places"]:
                key = f"{effect['name']}:{place['place']}" if place["place"] else effect["name"]
                self.places[key] = self._place(place)

    def _gram(self, motor, use):
        """Inner products (C + 2, C + 2) of [columns, modelled, error]."""
        size = len(motor["columns"]) + 2
        factor = np.zeros((size, size))
        given = motor[use]["triangle"]
        if given is None:
            return np.zeros((self.count + 2,) * 2)
        if isinstance(given, str):
            factor[np.triu_indices(size)] = numbers(given)
        else:
            inner = np.zeros((size - 2, size - 2))
            inner[np.triu_indices(size - 2, 1)] = numbers(given["counts"], "<i2")
            factor[:-2, :-2] = inner * numbers(given["steps"])[:, None] + np.diag(numbers(given["diagonal"]))
            factor[:, -2:] = numbers(given["answers"]).reshape(-1, 2)
            factor *= numbers(given["sizes"])
        index = np.append(motor["columns"], [self.count, self.count + 1])
        gram = np.zeros((self.count + 2,) * 2)
        gram[np.ix_(index, index)] = factor.T @ factor
        return gram

    def _place(self, place):
        k, size, follows = len(place["parameters"]), place["stop"] - place["start"], place["follows"]
        shape = (-1, 1 + (follows["count"] if follows else 0), k, size)
        own = SimpleNamespace(**place, k=k, size=size, coordinates=None, values=None)
        own.tables = [numbers(piece["table"]).reshape(shape) for piece in place["pieces"]]
        if place["table"]:
            own.values = numbers(place["table"]).reshape(shape)[0]
        if follows:
            own.coordinates = np.zeros((follows["count"], self.count))
            own.coordinates[:, follows["columns"]] = numbers(follows["coordinates"]).reshape(
                follows["count"], -1
            )
        return own

    def coefficients(self, place, value, branch, present):
        """(k, b) of the page's columns beside a present model."""
        scale = 1.0
        if place.scale != "none":
            scale = present.gains[place.motor]
            scale = scale if place.scale == "gain" else abs(scale)
        if place.kind == "linear" and place.values is None:
            return scale * np.eye(place.k)
        table = place.values if place.values is not None else self._interpolated(place, value, branch)
        total = table[0]
        if place.coordinates is not None:
            total = total + np.tensordot(place.coordinates @ present.difference, table[1:], axes=1)
        return scale * total

    @staticmethod
    def _piece(place, value, branch):
        """The stretch of an effect's scalar to which a value belongs."""
        own = [one for one in place.pieces if one["branch"] == branch]
        return min(own, key=lambda one: max(one["nodes"][0] - value, value - one["nodes"][-1], 0.0))

    def _interpolated(self, place, value, branch):
        piece = self._piece(place, value, branch)
        i = place.pieces.index(piece)
        nodes = np.array(place.pieces[i]["nodes"])
        change = np.log if place.pieces[i]["logarithmic"] else np.asarray
        at, x = change(nodes), change(np.clip(value, nodes[0], nodes[-1]))
        if np.abs(at - x).min() <= 1e-14 * np.abs(at).max():
            return place.tables[i][int(np.abs(at - x).argmin())]
        shares = np.array(
            [np.prod([(x - other) / (one - other) for other in at if other != one]) for one in at]
        )
        return np.tensordot(shares, place.tables[i], axes=1)

    def map_of(self, terms, present):
        """How [own, effects, known, modelled, error] follow from the page's columns."""
        p = self.own + sum(one.place.k for one in terms)
        found = np.zeros((self.count + 2, p + 3))
        found[np.arange(self.own), np.arange(self.own)] = 1.0
        at = self.own
        for one in terms:
            place = one.place
            coefficients = self.coefficients(place, one.value, one.branch, present)
            found[place.start : place.stop, at : at + place.k] = coefficients.T
            at += place.k
        found[self.own : self.count, p] = -self.reference[self.own :]
        found[self.count, p + 1] = found[self.count + 1, p + 2] = 1.0
        return found

    def vectors(self, d, gains):
        """Each motor's current error as a combination of [columns, known, modelled, error]."""
        return [
            np.concatenate((-d / g, [-1.0 / g, 1.0 - g0 / g, 1.0]))
            for g, g0 in zip(gains, self.gains0, strict=True)
        ]

    def errors(self, grams, d, gains):
        return np.array(
            [max(x @ gram @ x, 0.0) for x, gram in zip(self.vectors(d, gains), grams, strict=True)]
        )

    def kept(self, grams, p):
        """Columns that those before them, and the known payload, do not take up."""
        start = np.zeros(p)
        start[: self.own] = self.reference[: self.own]
        gram = np.zeros((p + 1, p + 1))
        for one, g in zip(grams, self.gains0, strict=True):
            take = np.zeros((p + 3, p + 1))
            take[:p, :p] = np.eye(p)
            take[:, p] = np.concatenate((-start, [1.0, g, 0.0]))
            gram += take.T @ one @ take
        norms = np.sqrt(np.diag(gram))
        largest = norms[: self.own].max()
        basis = [*range(self.own), *([p] if self.free else [])]
        basis = [i for i in basis if norms[i] > 0]
        norms[norms == 0.0] = 1.0
        gram /= np.outer(norms, norms)
        kept = list(range(self.own))
        for i in range(self.own, p):
            if norms[i] <= 1e-9 * largest or gram[i, i] == 0.0:
                continue
            inner = gram[np.ix_(basis, basis)]
            left = gram[i, i] - gram[i, basis] @ np.linalg.lstsq(inner, gram[basis, i], rcond=1e-14)[0]
            if left > self.dependent:
                kept.append(i)
                basis.append(i)
        return np.array(kept)

    def linear(self, grams, weights):
        """Weighted least squares of the torque's error: d and gains."""
        k = len(grams[0]) - 3
        size = k + (self.n if self.free else 0)
        normal, right = np.zeros((size, size)), np.zeros(size)
        for j, gram in enumerate(grams):
            columns, aim = np.zeros((k + 3, size)), np.zeros(k + 3)
            columns[:k, :k] = -np.eye(k)
            gain = self.gains0[j] if self.free else self.nominal[j]
            aim[k:] = -1.0, gain - self.gains0[j], gain
            if self.free:
                columns[k + 1 :, k + j] = 1.0
            normal += weights[j] ** 2 * columns.T @ gram @ columns
            right -= weights[j] ** 2 * columns.T @ gram @ aim
        x = scaled_solve(normal, right)
        return x[:k], self.gains0 + x[k:] if self.free else self.nominal

    def linearised(self, grams, d, gains, weights):
        """Normal matrix, right side and each motor's map of the linearised current errors."""
        k = len(d)
        size = k + (self.n if self.free else 0)
        normal, right, maps = np.zeros((size, size)), np.zeros(size), []
        for j, (gram, g, x) in enumerate(zip(grams, gains, self.vectors(d, gains), strict=True)):
            columns = np.zeros((k + 3, size))
            columns[:k, :k] = np.eye(k) / g
            if self.free:
                columns[: k + 2, k + j] = np.concatenate((-d, [-1.0, -self.gains0[j]])) / g**2
            maps.append(columns)
            normal += weights[j] ** 2 * columns.T @ gram @ columns
            right += weights[j] ** 2 * columns.T @ gram @ x
        return normal, right, maps

    def minimised(self, grams, d, gains, weights):
        k, cost = len(d), self.errors(grams, d, gains) @ weights**2
        for _ in range(50):
            normal, right, _ = self.linearised(grams, d, gains, weights)
            step = scaled_solve(normal, right)
            new_d, new_gains = d + step[:k], gains + step[k:] if self.free else gains
            new = self.errors(grams, new_d, new_gains) @ weights**2
            if new > cost * (1 + 1e-12):
                break
            settled = cost - new <= 1e-12 * cost
            d, gains, cost = new_d, new_gains, new
            if settled:
                break
        return d, gains

    def solve(self, terms, present):
        return self.solved(self.map_of(terms, present))

    def solved(self, columns):
        p = columns.shape[1] - 3
        grams = [columns.T @ one @ columns for one in self.grams["fitted"]]
        kept = self.kept(grams, p)
        index = np.append(kept, [p, p + 1, p + 2])
        taken = [one[np.ix_(index, index)] for one in grams]

        def torque_weights(d, gains):
            vectors = [x * g for x, g in zip(self.vectors(d, gains), gains, strict=True)]
            return 1.0 / np.sqrt([x @ one @ x / self.rows for x, one in zip(vectors, taken, strict=True)])

        d, gains = self.linear(taken, np.ones(self.n))
        for _ in range(3):
            d, gains = self.linear(taken, torque_weights(d, gains))
        for _ in range(3):
            weights = 1.0 / np.sqrt(self.errors(taken, d, gains) / self.rows)
            d, gains = self.minimised(taken, d, gains, weights)
        full, theta = np.zeros(p), np.zeros(p)
        full[kept] = theta[kept] = d
        theta[: self.own] += self.reference[: self.own]
        difference = (columns[:, : p + 1] @ np.append(full, 1.0))[: self.count]
        return SimpleNamespace(
            columns=columns, grams=grams, d=full, theta=theta, gains=gains, difference=difference, kept=kept
        )

    def besides(self, solution, place):
        """An effect's columns beside a solved model: Schur complements (b, b) and (b,), and inner products (b, b)."""
        p, b = len(solution.d), place.size
        extra = np.zeros((self.count + 2, b))
        extra[place.start : place.stop] = np.eye(b)
        index = np.append(solution.kept, [p, p + 1, p + 2])
        whole = np.concatenate((solution.columns[:, index], extra), axis=1)
        grams = [one[np.ix_(index, index)] for one in solution.grams]
        d = solution.d[solution.kept]
        p = len(d)
        errors = self.errors(grams, d, solution.gains)
        weights = 1.0 / np.sqrt(errors / np.maximum(self.moving, 1))
        normal, right, maps = self.linearised(grams, d, solution.gains, weights)
        cross, inner, score = np.zeros((len(normal), b)), np.zeros((b, b)), np.zeros(b)
        for j, (g, x) in enumerate(zip(solution.gains, self.vectors(d, solution.gains), strict=True)):
            gram = weights[j] ** 2 * whole.T @ self.grams["fitted"][j] @ whole
            inner += gram[p + 3 :, p + 3 :] / g**2
            cross += maps[j].T @ gram[: p + 3, p + 3 :] / g
            score += gram[p + 3 :, : p + 3] @ x / g
        explained = np.column_stack([scaled_solve(normal, one) for one in (*cross.T, right)])
        return inner - cross.T @ explained[:, :-1], score - cross.T @ explained[:, -1], inner

    def best_shape(self, place, besides, present, present_value):
        inner, score, whole = besides
        best = (np.inf, 0.0, 0)
        for branch, brackets in enumerate(place.brackets):

            def cost(value, branch=branch):
                c = self.coefficients(place, float(value), branch, present)
                left, right = c @ inner @ c.T, c @ score
                own = np.diag(c @ whole @ c.T)
                told = np.diag(left) > self.dependent * own
                return -float(right[told] @ scaled_solve(left[np.ix_(told, told)], right[told]))

            every = [*brackets, *self._nearby(place, present_value, brackets, branch)]
            costs = [cost(value) for _, value, _ in every]
            i = int(np.argmin(costs))
            low, value, high = every[i]
            best = min(best, (costs[i], value, branch))
            if low < high:
                xatol = 1e-4 * max(abs(low), abs(high))
                found = minimize_scalar(cost, bounds=(low, high), method="bounded", options={"xatol": xatol})
                best = min(best, (float(found.fun), float(found.x), branch))
        return best[1:]

    @staticmethod
    def _nearby(place, value, brackets, branch):
        """Around a shape's present value, where the page has columns."""
        if value <= 0.0 or all(low == high for low, _, high in brackets):
            return []
        for piece in place.pieces:
            nodes = piece["nodes"]
            if piece["branch"] == branch and len(nodes) > 1 and nodes[0] <= value <= nodes[-1]:
                return [[max(0.98 * value, nodes[0]), value, min(1.02 * value, nodes[-1])]]
        return []

    def settled(self, terms, found):
        """Shapes found, by steps of Gauss and Newton after the first search, and columns linearised."""
        present = self.solve([one for one in terms if not one.place.curved], found)
        shaped = [one for one in terms if one.place.kind == "shape"]
        before = None
        for _ in range(6):
            reached = None if before is None else self.stepped(terms, present)
            if reached is None:
                for one in shaped:
                    others = self.solve([other for other in terms if other is not one], present)
                    besides = self.besides(others, one.place)
                    one.value, one.branch = self.best_shape(one.place, besides, present, one.value)
                reached = self.solve(terms, present)
            present = reached
            self._about(terms, present.theta)
            left = np.sqrt(self.errors(present.grams, present.d, present.gains))
            now = (present.gains, np.array([one.value for one in shaped]), left)
            if before is not None:
                gains, shapes, errors = (
                    bool(np.all(np.abs(x - y) <= share * np.abs(x)))
                    for x, y, share in zip(now, before, (1e-4, 1e-4, 1e-6), strict=True)
                )
                if gains and (shapes or errors):
                    break
            before = now
        return present

    def stepped(self, terms, present):
        """All shapes moved at once, with all linear unknowns, and solved; None where nothing moves or that is worse."""
        moving = [
            one
            for one in terms
            if one.place.kind == "shape"
            and any(low < high for low, _, high in one.place.brackets[one.branch])
        ]
        if not moving:
            return None
        now = self.solve(terms, present)
        added, at = [], self.own
        for one in terms:
            theta = now.theta[at : at + one.place.k]
            at += one.place.k
            if one in moving:
                step = 1e-3 * (abs(one.value) or 1.0)
                low, high = (
                    self.coefficients(one.place, one.value + by, one.branch, present) for by in (-step, step)
                )
                column = np.zeros(self.count + 2)
                column[one.place.start : one.place.stop] = theta @ (high - low) / (2.0 * step)
                added.append(column)
        columns = np.insert(now.columns, [at], np.column_stack(added), axis=1)
        steps = self.solved(columns).d[at:]
        values = [one.value for one in moving]
        for one, step in zip(moving, steps, strict=True):
            most = 0.5 * abs(one.value)
            nodes = self._piece(one.place, one.value + np.clip(step, -most, most), one.branch)["nodes"]
            one.value = float(np.clip(one.value + np.clip(step, -most, most), nodes[0], nodes[-1]))
        after = self.solve(terms, present)
        before, reached = (self.errors(one.grams, one.d, one.gains) for one in (now, after))
        if (reached / before).mean() <= 1.0 + 1e-9:
            return after
        for one, value in zip(moving, values, strict=True):
            one.value = value
        return None

    def fit(self, keys):
        terms = [
            SimpleNamespace(
                key=key, place=place, branch=0, value=place.shape["value"] if place.kind == "shape" else 0.0
            )
            for key, place in self.places.items()
            if key in keys
        ]
        present = SimpleNamespace(gains=self.gains0, difference=np.zeros(self.count))
        if any(one.place.curved for one in terms):
            present = self.settled(terms, present)
        solution = self.solve(terms, present)
        judged = [solution.columns.T @ one @ solution.columns for one in self.grams["judged"]]
        left = {"fitted": solution.grams, "judged": judged}
        errors = {
            use: float(
                np.sqrt(
                    self.errors(grams, solution.d, solution.gains).sum() / (self.squares[use].sum() or 1.0)
                )
            )
            for use, grams in left.items()
        }
        return SimpleNamespace(**errors, gains=solution.gains, effects=self._named(terms, solution.theta))

    def _about(self, terms, theta):
        at = self.own
        for one in terms:
            if one.place.kind == "value":
                one.value = theta[at]
            at += one.place.k

    def _named(self, terms, theta):
        found, at = {}, self.own
        for one in terms:
            values = {each["name"]: theta[at + i] for i, each in enumerate(one.place.parameters)}
            at += one.place.k
            if one.place.kind == "shape":
                values[one.place.shape["name"]] = one.value
            found[one.key] = values
        return found


def scaled_solve(normal, right):
    norms = np.sqrt(np.maximum(np.diag(normal), 0.0))
    norms[norms == 0.0] = 1.0
    return np.linalg.lstsq(normal / np.outer(norms, norms), right / norms, rcond=1e-15)[0] / norms
