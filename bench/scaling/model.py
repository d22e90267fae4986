#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Model of many machines that render parts of one image, and of their file server: when each begins to render, and the
load of the server.

    bench/scaling/model.py [--machines 1000] [--scene-gb 10] [--files 200] [--names 2000] [--server-gb-s 10]
        [--link-gb-s 1.25] [--names-s 50000] [--parse-s 60] [--build-s 60] [--render-s 3600] [--film-mb 90]
        [--every-s 600] [--stagger-s 0] [--json]

A machine looks up names, reads the scene at the rate of its link and its share of the server, builds, renders, and
writes its film periodically. The server's rate is divided evenly among its current users. Figures of a real render:
reads.py.
"""
import argparse
import heapq
import itertools
import json
import sys


class Clock:
    def __init__(self):
        self.now, self.events, self.order = 0.0, [], itertools.count()

    def at(self, time, action):
        heapq.heappush(self.events, (time, next(self.order), action))

    def run(self):
        while self.events:
            self.now, _, action = heapq.heappop(self.events)
            action()


class Share:
    """A rate that is divided evenly among its users, each of whom gets at most `most`.

    All users get equal amounts, so the amount per user since the start is one number, `given`, which determines who
    finishes next.
    """

    def __init__(self, clock, rate, most):
        self.clock, self.rate, self.most = clock, rate, most
        self.users, self.given, self.since, self.order, self.version = [], 0.0, 0.0, itertools.count(), 0
        self.amount, self.busy_s, self.most_users = 0.0, 0.0, 0

    def each(self):
        return min(self.most, self.rate / len(self.users)) if self.users else 0.0

    def advance(self):
        passed = self.clock.now - self.since
        self.given += self.each() * passed
        self.amount += self.each() * len(self.users) * passed
        self.busy_s += passed if self.users and self.each() < self.most else 0
        self.since = self.clock.now

    def use(self, amount, then):
        self.advance()
        heapq.heappush(self.users, (self.given + amount, next(self.order), then))
        self.most_users = max(self.most_users, len(self.users))
        self.plan()

    def plan(self):
        self.version += 1
        if self.users:
            version = self.version
            left = max(0.0, self.users[0][0] - self.given)
            self.clock.at(self.clock.now + left / self.each(), lambda: self.end(version))

    def end(self, version):
        if version != self.version:
            return
        self.advance()
        _, _, then = heapq.heappop(self.users)
        self.plan()
        then()


class Machine:
    def __init__(self, farm, number):
        self.farm, self.o, self.number = farm, farm.options, number
        self.reading_s = self.rendering_s = self.ended_s = None
        farm.clock.at(number * self.o.stagger_s / max(1, self.o.machines), self.begin)

    def begin(self):
        self.farm.names.use(self.o.names, self.read)

    def read(self):
        self.reading_s = self.farm.clock.now
        self.farm.reads.use(self.o.scene_gb * 1e9, self.build)

    def build(self):
        self.farm.clock.at(self.farm.clock.now + self.o.parse_s + self.o.build_s, self.render)

    def render(self):
        self.rendering_s = self.farm.clock.now
        self.go_on()

    def go_on(self):
        done = self.farm.clock.now - self.rendering_s
        wait = min(self.o.every_s, self.o.render_s - done)
        self.farm.clock.at(self.farm.clock.now + wait, self.write)

    def write(self):
        # Rendering waits only for the last write.
        is_last = self.farm.clock.now - self.rendering_s >= self.o.render_s - 1e-6
        self.farm.writes.use(self.o.film_mb * 1e6, self.end if is_last else lambda: None)
        if not is_last:
            self.go_on()

    def end(self):
        self.ended_s = self.farm.clock.now


class Farm:
    def __init__(self, options):
        self.options, self.clock = options, Clock()
        link, server = options.link_gb_s * 1e9, options.server_gb_s * 1e9
        self.names = Share(self.clock, options.names_s, options.names_link_s)
        self.reads, self.writes = Share(self.clock, server, link), Share(self.clock, server, link)
        self.machines = [Machine(self, number) for number in range(options.machines)]
        self.clock.run()

    def result(self):
        o, begun = self.options, sorted(m.rendering_s for m in self.machines)
        ended = max(m.ended_s for m in self.machines)
        alone = o.names / min(o.names_s, o.names_link_s) + o.scene_gb * 1e9 / min(self.reads.rate, self.reads.most) + o.parse_s + o.build_s
        return {"first_renders_s": begun[0], "half_render_s": begun[len(begun) // 2], "last_renders_s": begun[-1], "alone_s": alone,
                "all_ended_s": ended, "read_tb": self.reads.amount / 1e12, "names": self.names.amount, "server_reads_full_s": self.reads.busy_s,
                "machines_reading_at_once": self.reads.most_users, "written_tb": self.writes.amount / 1e12,
                "written_gb_s_while_rendering": self.writes.amount / 1e9 / max(1e-9, ended - begun[0]), "machines_writing_at_once": self.writes.most_users,
                "work_share": o.machines * o.render_s / (o.machines * ended)}


def parser():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, default, kind in (("machines", 1000, int), ("scene-gb", 10, float), ("names", 2000, float), ("server-gb-s", 10, float),
                                ("link-gb-s", 1.25, float), ("names-s", 50000, float), ("names-link-s", 2000, float), ("parse-s", 60, float),
                                ("build-s", 60, float), ("render-s", 3600, float), ("film-mb", 90, float), ("every-s", 600, float),
                                ("stagger-s", 0, float)):
        p.add_argument("--" + name, type=kind, default=default)
    p.add_argument("--json", action="store_true")
    return p


if __name__ == "__main__":
    chosen = parser().parse_args()
    found = Farm(chosen).result()
    if chosen.json:
        json.dump(found, sys.stdout)
        print()
    else:
        for key, value in found.items():
            print(f"{key:32} {value:,.3f}")
