// A guide image by Intel's Open Image Denoise (https://www.openimagedenoise.org), where its library is installed. It is
// loaded when it is asked for; nothing of it is needed to build.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace gradus {

class Denoiser {
  public:
    /// Planes of an image as PoissonImages has them; albedo and normal both or neither.
    struct Images {
        const float *color = nullptr, *albedo = nullptr, *normal = nullptr;
    };

    /// `library`: the file to load; empty: what the environment variable GRADUS_DENOISER names, or else the system's
    /// libOpenImageDenoise. `threads` 0: all. Throws Error(ExitCode::usage), which says what to install, where there is
    /// none.
    explicit Denoiser(const std::string &library = "", int threads = 0);
    ~Denoiser();
    Denoiser(const Denoiser &) = delete;
    Denoiser &operator=(const Denoiser &) = delete;

    /// Writes the denoised image of three channels, of values from 0 on without a bound, to `result`, which may be
    /// that of `color`. Albedo and normal are denoised first, so that they may be noisy. What is not finite counts as
    /// 0. Throws Error(ExitCode::device) where the library fails.
    void run(const Images &images, std::uint32_t width, std::uint32_t height, float *result);
    /// "2.5.1"
    std::string version() const;

  private:
    struct Library;
    std::unique_ptr<Library> library_;
};

} // namespace gradus
