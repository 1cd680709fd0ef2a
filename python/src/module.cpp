#include "bindings.h"
#include "selvage/version.h"

#include <tbb/global_control.h>

#include <memory>
#include <mutex>

namespace selvage::python {

namespace {

/// At most so many threads work from now on, until the object is closed.
class ThreadLimit {
 public:
  explicit ThreadLimit(int count) : count_(count) {
    if (count < 1) throw Error("threads", std::to_string(count) + " were asked for", "give at least 1");
  }
  void open() { control_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count_)); }
  void close() { control_.reset(); }

 private:
  int count_;
  std::optional<tbb::global_control> control_;
};

}  // namespace

void bind_errors(nb::module_&) {
  static PyObject* error = nullptr;
  static PyObject* system_error = nullptr;
  const nb::module_ errors = nb::module_::import_("selvage._errors");
  error = errors.attr("Error").ptr();  // kept alive by the module, which Python never drops
  system_error = errors.attr("SystemError").ptr();
  nb::register_exception_translator(
      [](const std::exception_ptr& thrown, void*) {
        try {
          std::rethrow_exception(thrown);
        } catch (const SystemError& e) {
          PyErr_SetString(system_error, e.what());
        } catch (const Error& e) {
          PyErr_SetString(error, e.what());
        }
      },
      nullptr);
}

NB_MODULE(_native, m) {
  m.doc() = "The library behind the package selvage, which offers all of this under its own name.";
  m.attr("version") = version();
  prepare_arrays();
  bind_errors(m);
  nb::class_<ThreadLimit>(m, "threads",
                          R"(Limits the number of threads inside a `with` block, for all threads of the program.

Results are the same bits for any number of threads.

Parameters
----------
count : int
    How many threads may work at once; at least 1.

Raises
------
selvage.Error
    When the count is below 1.

Examples
--------
>>> with selvage.threads(1):
...     selvage.has_self_collisions(selvage.make("ball"))
False
)")
      .def(nb::init<int>(), nb::arg("count"))
      .def(
          "__enter__", [](ThreadLimit& limit) { limit.open(); }, nb::sig("def __enter__(self) -> None"))
      .def(
          "__exit__", [](ThreadLimit& limit, const nb::args&) { limit.close(); },
          nb::sig("def __exit__(self, *args: object) -> None"));
  bind_meshes(m);
  bind_mesh_files(m);
  bind_shapes(m);
  bind_paths(m);
  bind_self_collision(m);
  bind_continuous_collision(m);
  bind_proximity(m);
  bind_surface_distance(m);
  bind_contacts(m);
  bind_geometry(m);
  bind_keyframes(m);
  bind_scenes(m);
  bind_simulation(m);
  bind_runs(m);
  bind_resolve(m);
}

}  // namespace selvage::python
