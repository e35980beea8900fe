"""Draws carried out on a cluster: by processes of this machine, or by the workers of others."""

from __future__ import annotations

import asyncio
import logging
import re
import tempfile
import time
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import replace
from types import ModuleType
from typing import TYPE_CHECKING

from clepsydra.base.errors import Finding, InputError
from clepsydra.engine.host import host
from clepsydra.engine.threads import available_threads
from clepsydra.studies.robustness.campaign import Campaign
from clepsydra.studies.robustness.crew import Crew
from clepsydra.studies.robustness.drawn_loops import DrawnLoops
from clepsydra.studies.robustness.tally import Tally
from clepsydra.studies.robustness.workers_alike import (
    WorkerAnswer,
    drawing_nothing,
    own_answer,
    refusal,
)

if TYPE_CHECKING:
    from distributed import Client

_LOG = logging.getLogger(__name__)
#: How long a scheduler, a worker, or what a worker says of itself is waited for [s].
_PATIENCE = 45.0
_ADDRESS = re.compile(r"(tcp|tls)://(\[[0-9a-fA-F:.]+\]|[^\s:/\[\]]+):[0-9]{1,5}")
_LISTENING = "a scheduler of dask.distributed that listens"
_CHECK = (
    "check host and port, and that the scheduler runs; certificates for tls:// are named in the "
    "configuration of dask"
)


class Cluster:
    """Workers that carry out the draws of campaigns, from `local_workers` or `cluster_at`.

    Attributes
    ----------
    fuses : bool
        Whether all processors that were there at first, and that of this machine, fuse
        multiply-adds.
    notes : list of str
        What was found out about the workers, and is to be told with the result.
    """

    def __init__(self, client: Client, place: str) -> None:
        self._client, self._place = client, place
        self.notes = list[str]()
        self.fuses = self._all_fuse()

    def fitted(self, loops: DrawnLoops) -> DrawnLoops:
        """Return loops whose draws are the same, bit for bit, on every processor of the cluster."""
        return loops if self.fuses or not loops.fuse else replace(loops, fuse=False)

    def carry(
        self, campaign: Campaign, chunks: Iterable[int]
    ) -> Generator[tuple[int, Tally], None, None]:
        """Carry chunks out, see `Campaign.run`.

        Workers that come are given chunks, and what one that goes had in hand is given to others.
        Closing it, as an interruption does, calls off what has not begun.

        Raises
        ------
        InputError
            No worker is left that may work, or the cluster has gone.
        """
        return Crew(self._client, campaign, self._place, self._tell).carry(chunks)

    def _tell(self, words: str) -> None:
        if words not in self.notes:
            self.notes.append(words)
            _LOG.warning("%s", words)

    def _all_fuse(self) -> bool:
        """Ask every worker that is there what it is, and tell whether all processors fuse."""
        said, own = self._said(), own_answer()
        for address, answer in said.items():
            error = refusal(address, answer, own)
            if error is not None:
                raise error
        fusing = [host().fuses, *(each.fuses for each in said.values())]
        if any(fusing) and not all(fusing):
            self._tell(
                f"{fusing.count(False)} of {len(fusing)} processors fuse no multiply-adds, so no "
                "draw is made with fused ones: the bits are the same wherever it is made."
            )
        return all(fusing)

    def _said(self) -> dict[str, WorkerAnswer]:
        """Return what each worker says of itself; one that is busy is asked again in `carry`."""
        from distributed import CancelledError

        client = self._client
        try:
            client.wait_for_workers(1, timeout=_PATIENCE)
        except TimeoutError:
            raise InputError(
                self._place, Finding("a scheduler without workers"),
                f"a worker within {_PATIENCE:g} s", "start some: dask worker ADDRESS",
            ) from None  # fmt: skip
        asked = {
            address: client.submit(
                own_answer, workers=[address], allow_other_workers=False, pure=False
            )
            for address in client.nthreads()
        }
        said, end = dict[str, WorkerAnswer](), time.monotonic() + _PATIENCE
        for address, future in asked.items():
            with suppress(TimeoutError, CancelledError):
                try:
                    said[address] = future.result(timeout=max(end - time.monotonic(), 0.1))
                except (ImportError, AttributeError) as error:
                    raise drawing_nothing(address, error) from error
                except RuntimeError as error:  # the scheduler reads what it is to pass on
                    raise InputError(
                        self._place, Finding("a scheduler that does not know Clepsydra"),
                        f"one where Clepsydra {own_answer().versions['Clepsydra']} is installed",
                        "install it there too",
                    ) from error  # fmt: skip
        if not said:
            raise InputError(
                self._place, Finding("workers that do not answer"),
                f"one that says what it is within {_PATIENCE:g} s",
                f"install Clepsydra {own_answer().versions['Clepsydra']} where they run, or wait "
                "until they are done with what others have asked for",
            )  # fmt: skip
        return said


@contextmanager
def local_workers(count: int) -> Iterator[Cluster]:
    """Start worker processes on this machine, and end them.

    Each works on one thread. They listen on this machine alone, and only to who has a key that is
    made for them and never leaves the memory: whoever can talk to a worker can make it do anything.

    Parameters
    ----------
    count : int

    Raises
    ------
    InputError
        There are no more processors, the workers do not start, or `clepsydra[cluster]` is not
        installed.
    """
    most = max(available_threads(), 2)
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= most:
        raise InputError(
            "workers", count, f"a whole number from 1 to {most}", "more than processors do no more"
        )
    distributed = _distributed()
    import dask

    # No page of the scheduler or of a worker; a port on this machine remains, without content.
    quiet: dict[str, list[str]] = {
        "distributed.scheduler.http.routes": [],
        "distributed.worker.http.routes": [],
    }
    with tempfile.TemporaryDirectory(prefix="clepsydra-workers-") as folder:
        try:
            with dask.config.set(quiet):
                cluster = distributed.LocalCluster(
                    n_workers=count,
                    threads_per_worker=1,
                    host="127.0.0.1",
                    security=distributed.Security.temporary(),
                    scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
                    worker_dashboard_address=None,
                    memory_limit=0,
                    local_directory=folder,
                    preload="clepsydra.studies.robustness.local_worker",
                    silence_logs=logging.CRITICAL,
                )
        except (RuntimeError, OSError) as error:
            raise InputError(
                "workers", Finding("processes that do not start"), f"{count} that do",
                'in a script, begin below if __name__ == "__main__":',
            ) from error  # fmt: skip
        with cluster, distributed.Client(cluster, set_as_default=False) as client:
            yield Cluster(client, "workers")


@contextmanager
def cluster_at(address: str) -> Iterator[Cluster]:
    """Connect to a scheduler of dask.distributed, and leave it as it is.

    The scheduler and its workers take orders from anybody who can reach them, and this machine
    unpickles what they return: name one that only people can reach whom you would give a shell.
    Certificates for `tls://` are those of dask's own configuration.

    Parameters
    ----------
    address : str
        As tcp://host:port.

    Raises
    ------
    InputError
        There is no scheduler, it has no worker, a worker has another version of Clepsydra, or
        `clepsydra[cluster]` is not installed.
    """
    place = f"cluster, {address}"
    if not _ADDRESS.fullmatch(address):
        raise InputError("cluster", address, "an address as tcp://host:8786", "write it like that")
    distributed = _distributed()
    # A client waits for ever for one who listens and says nothing; so that is found out before.
    with ThreadPoolExecutor(1) as thread:  # this one may have a loop of its own, as in a notebook
        try:
            kind = thread.submit(asyncio.run, _kind(address)).result()
        except Exception as error:  # of the network, of certificates, or of what is no scheduler
            words = str(error).strip().partition("\n")[0] or "no answer"
            raise InputError(place, Finding(words), _LISTENING, _CHECK) from error
    if kind != "Scheduler":
        raise InputError(place, Finding(f"a {kind.lower()}"), _LISTENING, _CHECK)
    with distributed.Client(address, timeout=_PATIENCE, set_as_default=False) as client:
        yield Cluster(client, place)


async def _kind(address: str) -> str:
    """Return what is at an address: a scheduler, a worker or a nanny of one."""
    import distributed

    arguments = distributed.Security().get_connection_args("client")
    asked = distributed.rpc(address, connection_args=arguments)
    try:
        said = await asyncio.wait_for(asked.identity(), _PATIENCE)
    finally:
        await asked.close_rpc()
    return str(said["type"])


def _distributed() -> ModuleType:
    """Return dask.distributed, which only who asks for a cluster needs."""
    try:
        import cryptography  # noqa: F401
        import distributed
    except ImportError as error:
        raise InputError(
            "cluster", Finding(f"no package {error.name}"), "dask.distributed",
            "pip install 'clepsydra[cluster]'",
        ) from None  # fmt: skip
    return distributed
