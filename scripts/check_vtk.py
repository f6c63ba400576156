#!/usr/bin/env python3
"""Checks with VTK, which ParaView is built on, that the frames of a run open and hold what the run says.

usage: check_vtk.py RUN_DIRECTORY...                needs: pip install vtk
       check_vtk.py --same RUN_DIRECTORY...         the runs hold the same particles and values, in whatever order and files
"""

import csv
import json
import math
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPPolyDataReader

import numpy

SYMMETRIC = ["XX", "YY", "ZZ", "XY", "YZ", "XZ"]
# Fields that are pure numbers; all others have a unit.
PURE = {"id", "body", "material", "plastic_strain", "plastic_strain_increment", "neighbors", "adapted", "last_searched"}


class Complaint(Exception):
    """Something in the run is not as it should be."""


def require(condition, complaint):
    if not condition:
        raise Complaint(complaint)


def read(path):
    """The polydata of a frame; a warning of VTK is an error here."""
    complaints = []
    reader = vtkXMLPPolyDataReader() if path.suffix == ".pvtp" else vtkXMLPolyDataReader()
    for event in ("ErrorEvent", "WarningEvent"):
        reader.AddObserver(event, lambda caller, name: complaints.append(name))
    require(reader.CanReadFile(str(path)), f"{path}: VTK does not take it for polydata")
    reader.SetFileName(str(path))
    reader.Update()
    require(not complaints and reader.GetErrorCode() == 0, f"{path}: VTK complains")
    return reader.GetOutput()


def unit_of(array):
    return array.GetInformation().Get(vtkDataArray.UNITS_LABEL()) or ""


def words_of(frame, name):
    """The words of an array of field data."""
    array = frame.GetFieldData().GetAbstractArray(name)
    return [] if array is None else [array.GetValue(k) for k in range(array.GetNumberOfTuples())]


def check_names(path, frame, bodies):
    """Units and names, as VTK has read them."""
    require(words_of(frame, "BodyName") == bodies, f"{path}: bodies are {words_of(frame, 'BodyName')}")
    materials = words_of(frame, "BodyMaterial")
    require(len(materials) == len(bodies) and all(materials), f"{path}: materials are {materials}")
    units = {"Points": unit_of(frame.GetPoints().GetData())}
    fields = frame.GetPointData()
    for k in range(fields.GetNumberOfArrays()):
        array = fields.GetArray(k)
        units[array.GetName()] = unit_of(array)
    require(units["Points"] == "m", f"{path}: positions are in {units['Points']!r}")
    for name, unit in units.items():
        require(bool(unit) != (name in PURE), f"{path}: the unit of {name} is {unit!r}")
    listed = [f"{name}: {unit}" for name, unit in units.items() if unit]
    require(words_of(frame, "Units") == listed, f"{path}: Units are {words_of(frame, 'Units')}, arrays have {listed}")
    numbers = fields.GetArray("body")
    require(numbers is None or numbers.GetRange()[1] < len(bodies), f"{path}: a body has no name")


def check_frame(path, time, particles, bodies):
    """One frame; returns the names of its fields."""
    frame = read(path)
    require(frame.GetNumberOfPoints() == particles, f"{path}: {frame.GetNumberOfPoints()} points, {particles} particles")
    require(frame.GetNumberOfVerts() == particles, f"{path}: {frame.GetNumberOfVerts()} vertex cells")
    connectivity = vtk_to_numpy(frame.GetVerts().GetConnectivityArray())
    require((connectivity == numpy.arange(particles)).all(), f"{path}: vertices are not the points in order")
    value = frame.GetFieldData().GetArray("TimeValue")
    require(value is not None and value.GetValue(0) == time, f"{path}: TimeValue is not {time}")
    check_names(path, frame, bodies)
    positions = vtk_to_numpy(frame.GetPoints().GetData())
    require(positions.dtype == numpy.float64, f"{path}: positions are {positions.dtype}")
    require(numpy.isfinite(positions).all(), f"{path}: a position is not finite")
    fields = frame.GetPointData()
    names = []
    for k in range(fields.GetNumberOfArrays()):
        array = fields.GetArray(k)
        name = array.GetName()
        names.append(name)
        require(array.GetNumberOfTuples() == particles, f"{path}: {name} has {array.GetNumberOfTuples()} values")
        require(numpy.isfinite(vtk_to_numpy(array)).all(), f"{path}: {name} is not finite everywhere")
        components = [array.GetComponentName(c) for c in range(array.GetNumberOfComponents())]
        if len(components) == 6:
            require(components == SYMMETRIC, f"{path}: components of {name} are {components}")
    require("density" not in names or fields.GetArray("density").GetRange()[0] > 0, f"{path}: a density is not positive")
    return names


def check_history(run, summary):
    """Whole lines, known columns, time up to where the summary says."""
    known = [column["name"] for column in json.loads((run / "history-columns.json").read_text())]
    with open(run / "history.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    require(rows and list(rows[0]) == known, "history.csv: other columns than history-columns.json")
    require(all(None not in row.values() and None not in row for row in rows), "history.csv: a line is not whole")
    times = [float(row["time"]) for row in rows]
    require(all(a < b for a, b in zip(times, times[1:])), "history.csv: time does not grow")
    require(summary["status"] == "failed" or times[-1] == summary["simulated_time"], "history.csv: ends elsewhere")
    units = {column["name"]: column["unit"] for column in json.loads((run / "history-columns.json").read_text())}
    require(units["time"] == "s" and units["kinetic_energy"] == summary["units"]["energy.kinetic"], "units differ")
    require(all(math.isfinite(float(row["kinetic_energy"])) for row in rows), "history.csv: an energy is not finite")
    return len(rows)


def frames_of(run):
    """Times and files of the frames, as the collection lists them."""
    series = ElementTree.parse(run / "fields.pvd").getroot()
    require(series.get("type") == "Collection", "fields.pvd: not a collection")
    return [(float(entry.get("timestep")), entry.get("file")) for entry in series.iter("DataSet")]


def files_of(run, frame):
    """A frame and the pieces it names, if it does."""
    if not frame.endswith(".pvtp"):
        return {frame}
    folder = Path(frame).parent
    pieces = ElementTree.parse(run / frame).getroot().iter("Piece")
    return {frame} | {str(folder / piece.get("Source")) for piece in pieces}


def by_id(run, file):
    """Every array of a frame, in the order of the particles' id."""
    frame = read(run / file)
    fields = frame.GetPointData()
    arrays = {fields.GetArray(k).GetName(): vtk_to_numpy(fields.GetArray(k)) for k in range(fields.GetNumberOfArrays())}
    arrays["Points"] = vtk_to_numpy(frame.GetPoints().GetData())
    order = numpy.argsort(arrays["id"])
    require((arrays["id"][order] == numpy.arange(len(order))).all(), f"{run / file}: not each particle once")
    return {name: values[order] for name, values in arrays.items()}


def check_same(runs):
    first, *others = runs
    expected = frames_of(first)
    for run in others:
        frames = frames_of(run)
        require([time for time, _ in frames] == [time for time, _ in expected], f"{run}: frames at other times")
        for (_, file), (_, of_first) in zip(frames, expected):
            found, wanted = by_id(run, file), by_id(first, of_first)
            require(found.keys() == wanted.keys(), f"{run / file}: other fields")
            for name, values in found.items():
                require(values.tobytes() == wanted[name].tobytes(), f"{run / file}: another {name}")
        pieces = max(len(files_of(run, file)) - 1 for _, file in frames)
        print(f"{run}: {len(frames)} frames, {pieces} pieces, hold what those of {first} do")


def check(run):
    summary = json.loads((run / "summary.json").read_text())
    entries = frames_of(run)
    require(entries, "fields.pvd: no frame")
    require(all(a < b for (a, _), (b, _) in zip(entries, entries[1:])), "fields.pvd: times do not grow")
    require(entries[0][0] == 0.0, "fields.pvd: the first frame is not at time zero")
    require(
        summary["status"] == "failed" or entries[-1][0] == summary["simulated_time"],
        "fields.pvd: the last frame is not at the end",
    )
    listed = set().union(*(files_of(run, file) for _, file in entries))
    present = {str(path.relative_to(run)) for path in (run / "fields").rglob("*vtp")}
    require(listed == present, f"fields.pvd lists other files than there are: {sorted(listed ^ present)}")
    bodies = [body["name"] for body in summary["bodies"]]
    names = {tuple(check_frame(run / file, time, summary["particles"], bodies)) for time, file in entries}
    require(len(names) == 1, "frames hold different fields")
    rows = check_history(run, summary)
    print(f"{run}: {len(entries)} frames of {summary['particles']} particles, {len(next(iter(names)))} fields, {rows} rows")


def main():
    runs = [Path(argument) for argument in sys.argv[1:]]
    if not runs:
        sys.exit(__doc__)
    if str(runs[0]) == "--same":
        try:
            check_same(runs[1:])
        except (Complaint, OSError, KeyError, ValueError, ElementTree.ParseError) as trouble:
            sys.exit(f"{type(trouble).__name__}: {trouble}")
        return
    for run in runs:
        try:
            check(run)
        except (Complaint, OSError, KeyError, ValueError, ElementTree.ParseError) as trouble:
            sys.exit(f"{run}: {type(trouble).__name__}: {trouble}")


if __name__ == "__main__":
    main()
