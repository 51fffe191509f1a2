"""From named resources to a cached WebGPU bind group."""

from __future__ import annotations

from typing import Any

from .commands import Commands
from .device import Gpu
from .slots import Slot, bind_group_layout

_MOST_KEPT = 256


class Bindings:
    """The bind groups of one set of slots, cached for each combination of resources."""

    def __init__(self, gpu: Gpu, slots: tuple[Slot, ...], *, compute: bool, label: str) -> None:
        self.slots, self.label, self.device = slots, label, gpu.device
        self.layout: Any = bind_group_layout(gpu.device, slots, compute=compute, label=label)
        # Parameters, whose place in a buffer each dispatch names, and all else.
        self._names = frozenset(slot.name for slot in slots)
        self.dynamic = [slot.name for slot in slots if slot.is_dynamic]
        self.fixed = [slot.name for slot in slots if not slot.is_dynamic]
        self._groups: dict[tuple[int, ...], tuple[Any, list[Any]]] = {}

    def bind(self, commands: Commands, encoder: Any, group: int, values: dict[str, Any]) -> None:
        """Set the bind group `group` of an open pass. Refuses missing and unknown names."""
        if values.keys() != self._names:
            missing, unknown = self._names - values.keys(), values.keys() - self._names
            raise TypeError(f"{self.label}: missing {sorted(missing)}, unknown {sorted(unknown)}")
        if commands.tally is not None:
            commands.tally.bound(commands.stage_name, (values[name] for name in self.fixed))
        # Parameters move in the arena, so they come as offsets; all else is named by the group,
        # which is made once for each set of resources.
        offsets = [commands.put(values[name]) for name in self.dynamic]
        resources = [values[name] for name in self.fixed]
        key = (id(commands), *map(id, resources))
        found = self._groups.get(key)
        if found is None:
            found = self._made(commands, values, resources)
            self._groups[key] = found
        encoder.set_bind_group(group, found[0], offsets)

    def _made(
        self, commands: Commands, values: dict[str, Any], resources: list[Any]
    ) -> tuple[Any, list[Any]]:
        """A new bind group for the cache, which makes room for it."""
        # What was released since, by a resize or with another map, is not bound again.
        for key, (_, held) in list(self._groups.items()):
            if any(getattr(resource, "handle", resource) is None for resource in held):
                del self._groups[key]
        if len(self._groups) >= _MOST_KEPT:
            self._groups.pop(next(iter(self._groups)))
        # The resources are kept beside the group: an id stays theirs while they live.
        return self.make(values, commands.arena), [commands, *resources]

    def make(self, values: dict[str, Any], params: Any) -> Any:
        """A bind group of these resources, not cached; parameters lie in the buffer `params`."""
        # Parameters are bound once, from the start of their buffer: offsets come with each use.
        entries = []
        for index, slot in enumerate(self.slots):
            if slot.is_dynamic and slot.struct is not None:
                size = slot.struct.dtype.itemsize
                resource: Any = {"buffer": params, "offset": 0, "size": size}
            else:
                value = values[slot.name]
                resource = getattr(value, "resource", value)
            entries.append({"binding": index, "resource": resource})
        return self.device.create_bind_group(label=self.label, layout=self.layout, entries=entries)
