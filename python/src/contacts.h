#pragma once

#include "selvage/contact/contact.h"

#include <nanobind/nanobind.h>

#include <span>

namespace selvage::python {

/// One array a member.
nanobind::object contact_arrays(std::span<const Contact> contacts);

}  // namespace selvage::python
