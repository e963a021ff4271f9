// The average of level 0's GGX lobes under a texel, at nodes of its own.
#pragma once
#include "baker/footprint.h"
#include "ggx.h"

namespace lumel::baker {

// Level 0 as lobes.
struct GgxBase {
    int width = 0, height = 0;
    std::vector<GgxTexel> texels;
    std::vector<GgxLobe> lobes;
    bool isIsotropic = true;
    const GgxTexel& at(int x, int y) const { return texels[size_t(y) * size_t(width) + size_t(x)]; }
    const GgxLobe& lobeAt(int x, int y) const { return lobes[size_t(y) * size_t(width) + size_t(x)]; }
};

// Means over the level-0 texels under one texel.
struct GgxMeans {
    glm::vec3 f0{0.0f};
    float strength = 0.0f; // luminance of F0, by which lobes are weighted; 1 where all are black
    bool isBlack = false;
    float alphaSquared = 0.0f; // weighted by strength
    GgxShape averaged;         // as an engine averages maps: the mean normal and mean roughness
};

class GgxAverage {
public:
    explicit GgxAverage(const GgxBase& base) : base_(base) {}

    // Of texel (x, y) of a level of this size.
    GgxMeans means(int x, int y, int width, int height);
    // Of the texel of the last means(): the average at nodes drawn from it, from `near` and from the averaged
    // lobe, a third each, with the weights by which products are summed (importance sampling of a mixture).
    void sum(const GgxMeans& means, const GgxShape& near);

    const GgxNodes& nodes() const { return nodes_; }
    // Error of strength * lobe, relative to the average's square.
    double error(float strength, const GgxShape& shape);

private:
    template<class Use>
    void forTexels(const Use& use) const;
    void place(const GgxMeans& means, const GgxShape& near);

    const GgxBase& base_;
    Footprint columns_{0.0, 1.0}, rows_{0.0, 1.0};
    GgxNodes nodes_;
    GgxNodes::Values average_{}, weights_{}, values_{};
    double square_ = 0.0; // of the average
};

float luminanceOf(glm::vec3 colour);

} // namespace lumel::baker
