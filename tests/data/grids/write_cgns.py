"""Writes the CGNS files of this folder that stand for those of other programs.

gmsh.cgns      two boxes meshed and written by gmsh (pip install gmsh), which links the CGNS library itself
by_hand.cgns   by h5py (pip install h5py), node by node as the SIDS say: two zones in single precision with 64-bit sizes, ghost
               planes (Rind_t), families, conditions on face centres, zones and donors named with the base, one zone in
               parts.cgns behind a link, periodic along y, a flow solution that is of no interest, compressed coordinates
plane.cgns     by h5py: a two-dimensional base, big-endian, a C round a strip, unit millimetre

Run: python write_cgns.py
"""
import sys

import h5py
import numpy as np

KIND = {"float64": "R8", "float32": "R4", "int32": "I4", "int64": "I8", "int8": "C1"}


def head(at, name, label, kind, flags=True):
    for key, text, size in (("name", name, 33), ("label", label, 33), ("type", kind, 3)):
        at.attrs.create(key, np.bytes_(text), dtype=h5py.string_dtype("ascii", size))
    if flags:
        at.attrs.create("flags", np.array([1], np.int32))


def text(words):
    return np.frombuffer(words.encode("ascii"), np.int8)


def node(parent, name, label, data=None, big=False, **storage):
    group = parent.create_group(name, track_order=True)
    if isinstance(data, str):
        data = text(data)
    head(group, name, label, "MT" if data is None else KIND[data.dtype.name])
    if data is not None:
        # Fortran's first index is HDF5's last.
        data = np.ascontiguousarray(data.transpose())
        group.create_dataset(" data", data=data.astype(data.dtype.newbyteorder(">")) if big else data, **storage)
    return group


def link(parent, name, path, file=None):
    group = parent.create_group(name, track_order=True)
    head(group, name, "", "LK")
    group.create_dataset(" path", data=text(path + "\0"))
    if file:
        group.create_dataset(" file", data=text(file + "\0"))
        group[" link"] = h5py.ExternalLink(file, path)
    else:
        group[" link"] = h5py.SoftLink(path)


def new(path):
    file = h5py.File(path, "w", libver=("v108", "v110"), track_order=True)
    head(file, "HDF5 MotherNode", "Root Node of HDF5 File", "MT", flags=False)
    file.create_dataset(" format", data=text("IEEE_LITTLE_32\0"))
    file.create_dataset(" hdf5version", data=text("HDF5 Version 1.14".ljust(33, "\0")))
    node(file, "CGNSLibraryVersion", "CGNSLibraryVersion_t", np.array([4.2], np.float32))
    return file


def zone(parent, name, nodes, position, real, whole, rind=0, big=False, **storage):
    d = len(nodes)
    sizes = np.zeros((d, 3), whole)
    sizes[:, 0] = nodes
    sizes[:, 1] = np.array(nodes) - 1
    out = node(parent, name, "Zone_t", sizes, big)
    node(out, "ZoneType", "ZoneType_t", "Structured")
    coordinates = node(out, "GridCoordinates", "GridCoordinates_t")
    if rind:
        node(coordinates, "Rind", "Rind_t", np.full(2 * d, rind, np.int32))
    index = np.meshgrid(*[np.arange(-rind, n + rind) for n in nodes], indexing="ij")
    for axis, values in zip("XYZ", position(*index)):
        node(coordinates, "Coordinate" + axis, "DataArray_t", np.asarray(values, real), big, **storage)
    return out


def indices(parent, name, first, last, label="IndexRange_t"):
    node(parent, name, label, np.array([first, last], np.int32).transpose())


def condition(parent, name, kind, first, last, family=None, place=None):
    bc = node(parent, name, "BC_t", kind)
    indices(bc, "PointRange", first, last)
    if family:
        node(bc, "FamilyName", "FamilyName_t", family)
    if place:
        node(bc, "GridLocation", "GridLocation_t", place)


def join(parent, name, donor, here, there, transform, translation=None):
    one = node(parent, name, "GridConnectivity1to1_t", donor)
    node(one, "Transform", '"int[IndexDimension]"', np.array(transform, np.int32))
    indices(one, "PointRange", *here)
    indices(one, "PointRangeDonor", *there)
    if translation is not None:
        periodic = node(node(one, "GridConnectivityProperty", "GridConnectivityProperty_t"), "Periodic", "Periodic_t")
        for key, value in (("RotationCenter", [0, 0, 0]), ("RotationAngle", [0, 0, 0]), ("Translation", translation)):
            node(periodic, key, "DataArray_t", np.array(value, np.float32))


def by_hand():
    """Zone 2: x 0..4, y 0..3, z 0..2, i j k along x y z. Zone 10: x 4..6, i along -y, j along x, k along z."""
    parts = new("parts.cgns")
    base = node(parts, "Parts", "CGNSBase_t", np.array([3, 3], np.int32))
    second = zone(base, "far", (4, 3, 3), lambda i, j, k: (4.0 + j, 3.0 - i, 1.0 * k), np.float32, np.int64)
    bcs = node(second, "ZoneBC", "ZoneBC_t")
    condition(bcs, "out", "FamilySpecified", (1, 3, 1), (4, 3, 3), "Outlet")
    condition(bcs, "bottom", "BCSymmetryPlane", (1, 1, 1), (3, 2, 1), place="KFaceCenter")
    condition(bcs, "top", "BCSymmetryPlane", (1, 1, 3), (3, 2, 3), place="FaceCenter")
    joined = node(second, "ZoneGridConnectivity", "ZoneGridConnectivity_t")
    join(joined, "to zone 2", "Base/zone 2", ((1, 1, 1), (4, 1, 3)), ((5, 4, 1), (5, 1, 3)), (-2, 1, 3))
    parts.close()

    file = new("by_hand.cgns")
    base = node(file, "Base", "CGNSBase_t", np.array([3, 3], np.int32))
    link(base, "zone 10", "/Parts/far", "parts.cgns")
    first = zone(base, "zone 2", (5, 4, 3), lambda i, j, k: (1.0 * i, 1.0 * j, 1.0 * k), np.float32, np.int64, rind=1,
                 chunks=True, compression="gzip", shuffle=True)
    bcs = node(first, "ZoneBC", "ZoneBC_t")
    condition(bcs, "in", "FamilySpecified", (1, 1, 1), (1, 4, 3), "Inlet")
    condition(bcs, "z low", "BCWallInviscid", (1, 1, 1), (5, 4, 1), "Wing")
    condition(bcs, "z high", "BCWallViscous", (5, 4, 3), (1, 1, 3), "Wing")
    joined = node(first, "ZoneGridConnectivity", "ZoneGridConnectivity_t")
    join(joined, "to zone 10", "zone 10", ((5, 1, 1), (5, 4, 3)), ((4, 1, 1), (1, 1, 3)), (2, -1, 3))
    join(joined, "round", "zone 2", ((1, 1, 1), (5, 1, 3)), ((1, 4, 1), (5, 4, 3)), (1, 2, 3), (0, 3, 0))
    join(joined, "and back", "zone 2", ((1, 4, 1), (5, 4, 3)), ((1, 1, 1), (5, 1, 3)), (1, 2, 3), (0, -3, 0))
    solution = node(first, "FlowSolution", "FlowSolution_t")
    node(solution, "Density", "DataArray_t", np.ones((5, 4, 3)))
    for name, kind in (("Inlet", "BCInflowSubsonic"), ("Outlet", "BCOutflowSubsonic"), ("Wing", "UserDefined")):
        node(node(base, name, "Family_t"), "FamilyBC", "FamilyBC_t", kind)
    file.close()


def plane():
    """A C of 9 x 3 nodes round a strip from x = 0 to 1: i 1..3 and 7..9 are the wake's two sides."""
    file = new("plane.cgns")
    base = node(file, "Plane", "CGNSBase_t", np.array([2, 2], np.int32))
    units = "Kilogram".ljust(32) + "Millimeter".ljust(32) + "Second".ljust(32) + "Kelvin".ljust(32) + "Radian".ljust(32)
    node(base, "DimensionalUnits", "DimensionalUnits_t", text(units).reshape(5, 32).transpose())

    def position(i, j):
        s = np.abs(i - 4.0)
        x = s / 2.0
        return x - 0.5 * j * (s == 0), np.sign(4 - i) * j * 1.0

    one = zone(base, "c", (9, 3), position, np.float64, np.int32, big=True)
    bcs = node(one, "ZoneBC", "ZoneBC_t")
    condition(bcs, "strip", "BCWall", (3, 1), (7, 1))
    condition(bcs, "far", "BCFarfield", (1, 3), (9, 3))
    condition(bcs, "exit above", "BCExtrapolate", (1, 1), (1, 3))
    condition(bcs, "exit below", "BCExtrapolate", (9, 1), (9, 3))
    joined = node(one, "ZoneGridConnectivity", "ZoneGridConnectivity_t")
    join(joined, "wake", "c", ((1, 1), (3, 1)), ((9, 1), (7, 1)), (-1, -2))
    file.close()


def gmsh():
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    occ, mesh = gmsh.model.occ, gmsh.model.mesh
    occ.fragment([(3, occ.addBox(0, 0, 0, 1, 1, 1))], [(3, occ.addBox(1, 0, 0, 2, 1, 1))])
    occ.synchronize()
    for _, curve in gmsh.model.getEntities(1):
        mesh.setTransfiniteCurve(curve, 5 if occ.getMass(1, curve) < 1.5 else 9)
    for _, surface in gmsh.model.getEntities(2):
        mesh.setTransfiniteSurface(surface)
        mesh.setRecombine(2, surface)
        x = occ.getCenterOfMass(2, surface)[0]
        if abs(x - 1) > 1e-9:
            name = "inflow" if x < 1e-9 else "outflow" if x > 2.9 else "wall"
            gmsh.model.addPhysicalGroup(2, [surface], name=f"{name} {surface}")
    for _, volume in gmsh.model.getEntities(3):
        mesh.setTransfiniteVolume(volume)
    gmsh.model.addPhysicalGroup(3, [v for _, v in gmsh.model.getEntities(3)], name="fluid")
    mesh.generate(3)
    gmsh.option.setNumber("Mesh.CgnsExportStructured", 1)
    gmsh.write("gmsh.cgns")


by_hand()
plane()
if "--no-gmsh" not in sys.argv:
    gmsh()
