#pragma once

#include "arrays.h"
#include "interrupts.h"
#include "selvage/contact/contact.h"
#include "selvage/core/error.h"
#include "selvage/mesh/simplex_mesh.h"
#include "selvage/mesh/triangle_mesh.h"
#include "selvage/scene/scene.h"
#include "selvage/self_collision/self_collision.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>

#include <optional>

namespace selvage::python {

/// What each file adds to the module.
void bind_errors(nb::module_& m);
void bind_meshes(nb::module_& m);
void bind_mesh_files(nb::module_& m);
void bind_shapes(nb::module_& m);
void bind_paths(nb::module_& m);
void bind_self_collision(nb::module_& m);
void bind_continuous_collision(nb::module_& m);
void bind_proximity(nb::module_& m);
void bind_surface_distance(nb::module_& m);
void bind_contacts(nb::module_& m);
void bind_geometry(nb::module_& m);
void bind_keyframes(nb::module_& m);
void bind_scenes(nb::module_& m);
void bind_simulation(nb::module_& m);
void bind_runs(nb::module_& m);
void bind_resolve(nb::module_& m);

/// A mesh of the package: the library's topology, and the positions that it was given, in place where they could be.
template <typename Topology, int D>
struct PlacedMesh {
  Topology topology;
  Rows<Vec<D>> positions;

  void place(nb::handle vertices) {
    Rows<Vec<D>> rows(vertices, "V");
    if (std::ssize(rows.span()) != topology.vertex_count())
      throw Error("V",
                  std::to_string(rows.span().size()) + " positions for " + std::to_string(topology.vertex_count()) +
                      " vertices",
                  "give one per vertex");
    positions = std::move(rows);
  }

  /// The positions of an argument; the mesh's own where it is None.
  Rows<Vec<D>> positions_or(nb::handle vertices, const char* name = "V") const {
    return Rows<Vec<D>>(vertices.is_none() ? nb::object(positions.array()) : nb::borrow(vertices), name);
  }
};

/// The mesh behind an argument.
template <typename Mesh>
const Mesh& mesh_argument(nb::handle mesh) {
  if (nb::isinstance<Mesh>(mesh)) return nb::cast<const Mesh&>(mesh);
  throw Error("mesh", std::string("a ") + Py_TYPE(mesh.ptr())->tp_name + " was given",
              "give a " + nb::cast<std::string>(nb::type<Mesh>().attr("__name__")));
}

using PlacedTetMesh = PlacedMesh<TetMesh, 3>;
using PlacedPlanarMesh = PlacedMesh<PlanarMesh, 2>;
using PlacedTriangleMesh = PlacedMesh<TriangleMesh, 3>;

/// Options of self-collision from keyword arguments of Python.
SelfCollisionOptions collision_options(const std::string& method, bool adjacent, bool asked_once, nb::handle filters,
                                       nb::handle thickness, const std::shared_ptr<Watch>& watch);
PairFilters filters_of(nb::handle filters);

/// Contacts, one array a member.
nb::object contact_arrays(std::span<const Contact> contacts);

/// A scene of the package: solvers that run it share it.
struct SceneHandle {
  std::shared_ptr<const Scene> scene;
};

/// All bodies of tetrahedra of a scene in one mesh, at these positions.
PlacedTetMesh mesh_of_scene(const Scene& scene, const nb::object& positions);

/// All of a scene that is seen and that collides, at these positions.
PlacedTriangleMesh surface_of_scene(const Scene& scene, const nb::object& positions);

/// Runs work without the interpreter.
template <typename Work>
auto without_interpreter(Work&& work) {
  const nb::gil_scoped_release released;
  return work();
}

/// A class that holds a Python function through Self::watch takes part in garbage collection by these slots.
template <typename Self>
struct CollectedWatch {
  static int traverse(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    if (!nb::inst_ready(self)) return 0;
    Self* const object = nb::inst_ptr<Self>(self);
    if (object->watch) Py_VISIT(object->watch->progress().ptr());
    return 0;
  }
  static int clear(PyObject* self) {
    if (!nb::inst_ready(self)) return 0;
    Self* const object = nb::inst_ptr<Self>(self);
    if (object->watch) object->watch->progress() = nb::none();
    return 0;
  }
  static inline PyType_Slot slots[3] = {{Py_tp_traverse, reinterpret_cast<void*>(&traverse)},
                                        {Py_tp_clear, reinterpret_cast<void*>(&clear)},
                                        {0, nullptr}};
};

}  // namespace selvage::python
