"""Rewrites a recording in the ways that other programs may: `python3 make.py BASE.mcap FOLDER` (pip install mcap).

BASE is written by the test `base` in ../others.rs.
"""
import json
import sys
from pathlib import Path

from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType, Writer

base, folder = sys.argv[1], Path(sys.argv[2])
with open(base, "rb") as f:
    reader = make_reader(f, validate_crcs=True)
    messages = [(s, c, m) for s, c, m in reader.iter_messages(log_time_order=False)]
    metadata = [(m.name, m.metadata) for m in reader.iter_metadata()]


def write(name, messages=messages, profile="dip", check=True, more=lambda w: None, change=lambda c, s: (c, s), **options):
    """`messages` are (schema, channel, message); `change` gives another encoding and schema to a channel."""
    with open(folder / name, "wb") as f:
        w = Writer(f, **options)
        w.start(profile=profile, library="make.py")
        for key, entries in metadata:
            if check or key != "dip.check":
                w.add_metadata(key, entries)
        more(w)
        ids = {}
        for s, c, m in messages:
            if c.topic not in ids:
                encoding, (sname, sencoding, sdata) = change(c.topic, ("protobuf", (s.name, s.encoding, s.data)))[1]
                schema = w.register_schema(name=sname, encoding=sencoding, data=sdata)
                ids[c.topic] = w.register_channel(topic=c.topic, message_encoding=encoding, schema_id=schema)
            w.add_message(
                channel_id=ids[c.topic], log_time=m.log_time, publish_time=m.publish_time, sequence=m.sequence, data=m.data
            )
        w.finish()


def with_(m, **values):
    return type(m)(**{**vars(m), **values})


write("lz4.mcap", compression=CompressionType.LZ4, chunk_size=3000)
write("one_chunk.mcap", compression=CompressionType.ZSTD)
write("not_packed.mcap", compression=CompressionType.NONE, chunk_size=5000)
write("no_chunks.mcap", use_chunking=False)
write(
    "no_summary.mcap",
    compression=CompressionType.LZ4,
    index_types=IndexType.NONE,
    repeat_channels=False,
    repeat_schemas=False,
    use_statistics=False,
    use_summary_offsets=False,
)
write("no_checksums.mcap", compression=CompressionType.LZ4, enable_crcs=False)
# The order of the patches is that of the surface's messages.
surface = [t for t in messages if t[1].topic == "/surface/grid"]
backwards = [t for t in messages[::-1] if t[1].topic != "/surface/grid"] + surface
write(
    "backwards.mcap",
    [(s, c, with_(m, sequence=0, log_time=max(0, m.log_time - (m.log_time % 3 == 1)))) for s, c, m in backwards],
    profile="",
    check=False,
    compression=CompressionType.LZ4,
)


def notes(w):
    w.add_metadata("somebody", {"else": "1"})
    w.add_attachment(create_time=0, log_time=0, name="note.txt", media_type="text/plain", data=b"a note")
    schema = w.register_schema(name="notes", encoding="jsonschema", data=b"{}")
    for topic in ["/notes", "/camera"]:
        channel = w.register_channel(topic=topic, message_encoding="json", schema_id=schema)
        w.add_message(channel_id=channel, log_time=5, publish_time=5, data=json.dumps({"text": "hello"}).encode())


write("more_channels.mcap", more=notes, compression=CompressionType.LZ4)
write(
    "twice.mcap", messages + [t for t in messages if t[2].sequence in (3, 4)], compression=CompressionType.LZ4
)
here = next(t[2].data for t in messages if t[1].topic == "/convergence" and t[2].sequence == 7)
flipped = here[:-1] + bytes([here[-1] ^ 1])
write(
    "contradiction.mcap",
    messages
    + [(s, c, with_(m, data=flipped)) for s, c, m in messages if c.topic == "/convergence" and m.sequence == 7],
    compression=CompressionType.LZ4,
)
write("short.mcap", [t for t in messages if t[2].sequence < 16], compression=CompressionType.LZ4)


def as_json(topic):
    def change(c, s):
        return (c, ("json", ("anything", "jsonschema", b"{}"))) if c == topic else (c, s)

    return change


write("json_loads.mcap", change=as_json("/loads"), compression=CompressionType.LZ4)
write("json_modal.mcap", change=as_json("/modal"), compression=CompressionType.LZ4)
write(
    "by_the_clock.mcap",
    [
        (s, c, with_(m, log_time=m.log_time + 1_700_000_000_000_000_000) if m.log_time else m)
        for s, c, m in messages
        if m.sequence > 0 or c.topic.startswith("/surface/")
    ],
    compression=CompressionType.LZ4,
)
