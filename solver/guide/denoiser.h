// A guide image by Intel's Open Image Denoise (https://www.openimagedenoise.org), where its library is installed. It is
// loaded when it is asked for; nothing of it is needed to build.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace gradus {

class Denoiser {
  public:
    /// Albedo and normal as run() takes them, of any number of images; empty: none.
    struct Features {
        std::vector<float> albedo, normal; ///< pixel by pixel
    };

    /// `library`: the file to load; empty: what the environment variable GRADUS_DENOISER names, or else the system's
    /// libOpenImageDenoise. `threads` 0: all. Throws Error(ExitCode::usage), which says what to install, where there is
    /// none.
    explicit Denoiser(const std::string &library = "", int threads = 0);
    ~Denoiser();
    Denoiser(const Denoiser &) = delete;
    Denoiser &operator=(const Denoiser &) = delete;

    /// Denoises albedo and normal by themselves. All images are planes of three channels, as PoissonImages has them;
    /// what is not finite counts as 0. Throws Error(ExitCode::device) where the library fails, as run() does.
    Features cleaned(const float *albedo, const float *normal, std::uint32_t width, std::uint32_t height);
    /// Writes the denoised image, of values from 0 on without a bound, to `result`, which may be `color`.
    void run(const float *color, const Features &features, std::uint32_t width, std::uint32_t height, float *result);
    /// "2.5.1"
    std::string version() const;

  private:
    struct Library;
    std::unique_ptr<Library> library_;
};

} // namespace gradus
