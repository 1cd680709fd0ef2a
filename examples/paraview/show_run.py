"""Draws a run without a display: pvbatch show_run.py RUN/frames.pvd OUT.png, of `selvage simulate ... --vtu`.

The run is cut open in the middle across y, and coloured by speed.
"""

import sys

from paraview import simple

run = simple.OpenDataFile(sys.argv[1])
run.UpdatePipeline()
last = run.TimestepValues[-1]
clip = simple.Clip(Input=run, ClipType="Plane")
lower, upper = run.GetDataInformation().GetBounds()[::2], run.GetDataInformation().GetBounds()[1::2]
clip.ClipType.Origin = [(a + b) / 2 for a, b in zip(lower, upper)]
clip.ClipType.Normal = [0, -1, 0]
view = simple.CreateView("RenderView")
view.ViewTime = last
shown = simple.Show(clip, view)
simple.ColorBy(shown, ("POINTS", "velocity", "Magnitude"))
shown.RescaleTransferFunctionToDataRange(True)
view.CameraPosition, view.CameraViewUp = [0, -1, 0], [0, 0, 1]
view.CameraFocalPoint = [0, 0, 0]
view.ResetCamera()
simple.SaveScreenshot(sys.argv[2], view, ImageResolution=[640, 480])
print(f"{len(run.TimestepValues)} frames to {last:.3f} s, {run.GetDataInformation().GetNumberOfCells()} elements")
