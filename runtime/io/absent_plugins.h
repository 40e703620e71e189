// What to say of plugins that scene files name and that are not there.
#pragma once

#include "runtime/io/location.h"

#include <string>

namespace gradus {

/// An error's text: what is known, and what is nearest. The category is the element's tag.
std::string unknown_plugin(const std::string &category, const std::string &type);
/// What is to be said of an integrator that is not there; empty where its image is the same.
std::string note_on_integrator(const std::string &type);
/// Throws SceneError for emitters that other programs have and this one has not.
void refuse_emitter(const std::string &type, const Location &location);

} // namespace gradus
