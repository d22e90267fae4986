// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include "fathom/vector.h"

/// Conversion between NumPy arrays and vectors of the description. Python code has checked shapes and values.
namespace fathom::python {

/// A row-major array whose rows are one T each, such as (n, 3) floats for Vec3f.
template <class Number>
using Rows = nanobind::ndarray<const Number, nanobind::ndim<2>, nanobind::c_contig, nanobind::device::cpu>;

/// Copies the rows. Throws std::invalid_argument unless a row has the size of T.
template <class T, class Number>
std::vector<T> to_vector(const Rows<Number>& rows)
{
    if (rows.shape(1) * sizeof(Number) != sizeof(T)) throw std::invalid_argument("rows of another length are expected");
    std::vector<T> values(rows.shape(0));
    if (!values.empty()) std::memcpy(values.data(), rows.data(), values.size() * sizeof(T));
    return values;
}

/// A NumPy array of a copy of the numbers, which the array owns.
template <class Number, class T>
nanobind::object to_array(const std::vector<T>& values, std::vector<std::size_t> shape)
{
    namespace nb = nanobind;
    const std::size_t bytes = values.size() * sizeof(T);
    auto data = std::make_unique<Number[]>(std::max<std::size_t>(bytes / sizeof(Number), 1));
    if (bytes > 0) std::memcpy(data.get(), values.data(), bytes);
    Number* numbers = data.get();
    const nb::capsule owner(data.release(), [](void* p) noexcept { delete[] static_cast<Number*>(p); });
    return nb::cast(nb::ndarray<nb::numpy, Number>(numbers, shape.size(), shape.data(), owner));
}

/// A read-only NumPy array of memory that `keeper` keeps alive.
template <class Number, class Keeper>
nanobind::object to_view(const Number* numbers, std::vector<std::size_t> shape, std::shared_ptr<Keeper> keeper)
{
    namespace nb = nanobind;
    using Shared = std::shared_ptr<Keeper>;
    const nb::capsule owner(new Shared(std::move(keeper)), [](void* p) noexcept { delete static_cast<Shared*>(p); });
    return nb::cast(nb::ndarray<nb::numpy, const Number>(numbers, shape.size(), shape.data(), owner));
}

}  // namespace fathom::python
