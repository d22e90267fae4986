// SPDX-License-Identifier: Apache-2.0
#include "error.h"

#include "commands/commands.h"
#include "fathom/error.h"

namespace fathom::python {

namespace nb = nanobind;

void bind_error(nb::module_& module)
{
    static PyObject* error_type = nullptr;
    nb::object type = nb::steal(PyErr_NewExceptionWithDoc(
        "fathom.Error",
        "Something outside the program is wrong: a file, a parameter of a scene, the machine.\n\n"
        "``str(error)`` is one line, ``file: place: message``. ``error.file`` and ``error.place`` are the parts that "
        "are\n"
        "known, otherwise ``None``.",
        PyExc_RuntimeError, nullptr));
    if (!type.is_valid()) nb::raise_python_error();
    module.attr("Error") = type;
    error_type = type.ptr();

    nb::register_exception_translator(
        [](const std::exception_ptr& exception, void*) {
            try {
                std::rethrow_exception(exception);
            } catch (const Error& error) {
                nb::object made = nb::handle(error_type)(error.what());
                const auto text = [](const std::string& part) {
                    return part.empty() ? nb::object(nb::none()) : nb::object(nb::str(part.c_str()));
                };
                made.attr("file") = text(error.file());
                made.attr("place") = text(error.place());
                PyErr_SetObject(error_type, made.ptr());
            } catch (const cli::UsageError& error) {
                PyErr_SetString(PyExc_ValueError, error.what());
            }
        },
        nullptr);
}

}  // namespace fathom::python
