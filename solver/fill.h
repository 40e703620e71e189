// Values for pixels that have none of their own: the mean of their neighbours, ring by ring.
#pragma once

#include "solver/workspace.h"

namespace gradus::solver {

class Fill {
  public:
    explicit Fill(Workspace &workspace) : workspace_(workspace) {}

    /// Gives every pixel of `image` whose `valid` is 0 the mean of its valid neighbours, then those next to them, and
    /// so on; all stay as they are where no pixel is valid. `valid` is 0 or 1 by pixel and is kept.
    void run(Buffer &image, const Buffer &valid);

  private:
    Workspace &workspace_;
    Buffer other_image_, valid_, other_valid_;
};

} // namespace gradus::solver
